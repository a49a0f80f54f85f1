"""The description of positioning tests; lengths are in m, angles in rad, temperatures in degrees Celsius."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator
from sher3_machines.intake.fields import Column, Description, Strict

FORCES = ("N", "kN", "N*m", "mN*m", "A", "mA", "V", "mV", "%")
"""Units that no position has."""
REFERENCE = 20.0
"""Temperature, deg C, at which lengths are stated (ISO 1)."""


class AxisTest(Strict):
    """A positioning test of one axis: a row for each time that a target was reached, or a row for each target.

    Attributes:
        name: of the axis.
        motion: linear or rotary.
        target: where the axis was sent.
        reading: where the reference found it; or `deviation`, reading less target; or `passes`, the deviations of each
            pass in a column of its own: from below, from above, and so on.
        direction: number whose sign says from where the target was reached; left out: from the order of the rows.
        cycle: number of the cycle; left out: counted, a cycle ends where a target is reached again from the same side.
        temperature: of the table or its scale, deg C, where it was recorded.
        reference_temperature: deg C.
        noise: standard deviation of a reading; needed where there is one cycle only.
        lead: travel per motor revolution: without it no period is named.
    """

    name: str = Field(min_length=1, pattern=r"^[^./]+$")
    motion: Literal["linear", "rotary"] = "linear"
    target: Column
    reading: Column | None = None
    deviation: Column | None = None
    passes: tuple[Column, ...] | None = Field(default=None, min_length=1)
    direction: Column | None = None
    cycle: Column | None = None
    temperature: Column | None = None
    reference_temperature: float = REFERENCE
    noise: float | None = Field(default=None, gt=0.0)
    lead: float | None = Field(default=None, gt=0.0)

    @model_validator(mode="after")
    def _either(self) -> AxisTest:
        if sum(x is not None for x in (self.reading, self.deviation, self.passes)) != 1:
            raise ValueError("state either `reading`, `deviation` or `passes`")
        if self.passes is not None and (self.direction is not None or self.cycle is not None):
            raise ValueError("`passes` say direction and cycle by their order: leave `direction` and `cycle` out")
        for column in (self.target, self.reading, self.deviation, *(self.passes or ())):
            if column is not None and column.unit in FORCES:
                raise ValueError(
                    f"{column.column!r} is in {column.unit}, and a positioning test has lengths or angles; a force "
                    "sensor is `kind: force_sensor`"
                )
        return self


class CircleTest(Strict):
    """A circle that two axes moved on: a row for each point, in the order of the motion.

    Attributes:
        name: of the plane.
        x, y: position of each point, of any centre; or `angle` and `deviation` of the radius, as a ball-bar gives them.
        radius: nominal, m.
        noise: standard deviation of a radius.
    """

    name: str = Field(min_length=1, pattern=r"^[^./]+$")
    x: Column | None = None
    y: Column | None = None
    angle: Column | None = None
    deviation: Column | None = None
    radius: float = Field(gt=0.0)
    noise: float | None = Field(default=None, gt=0.0)

    @model_validator(mode="after")
    def _either(self) -> CircleTest:
        stated = [n for n in ("x", "y", "angle", "deviation") if getattr(self, n) is not None]
        if stated not in (["x", "y"], ["angle", "deviation"]):
            raise ValueError("state either `x` and `y`, or `angle` and `deviation`")
        return self


class PositioningDescription(Description):
    """Positioning tests of a machine.

    Attributes:
        axes: tests of single axes.
        planes: circles of two axes.
    """

    kind: Literal["positioning"]
    axes: tuple[AxisTest, ...] = ()
    planes: tuple[CircleTest, ...] = ()

    @model_validator(mode="after")
    def _some(self) -> PositioningDescription:
        names = [test.name for test in self.axes] + [test.name for test in self.planes]
        if not names or len(set(names)) < len(names):
            raise ValueError("state `axes` or `planes`, each with a name of its own")
        return self
