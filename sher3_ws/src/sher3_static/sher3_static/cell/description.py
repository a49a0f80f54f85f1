"""The description of a load cell; forces in N, torques in N m."""

from __future__ import annotations

from typing import Literal

from pydantic import Field
from sher3_machines.intake.fields import Column, Description


class CellDescription(Description):
    """Readings of a force or torque sensor of one axis under known loads.

    Attributes:
        measures: force or torque.
        applied: known load: a weight, in N, kg, gf or lbf, or a better sensor.
        reading: of the cell; `factor` makes N (N m) of its unit by the data sheet, such as N per V.
        temperature: deg C, where it was recorded.
        noise: standard deviation of a reading, N or N m; left out: from what repeats.
    """

    kind: Literal["load_cell"]
    measures: Literal["force", "torque"] = "force"
    applied: Column
    reading: Column
    temperature: Column | None = None
    noise: float | None = Field(default=None, gt=0.0)

    @property
    def unit(self) -> str:
        """Unit of what is measured."""
        return "N" if self.measures == "force" else "N*m"
