"""The description of a force sensor; forces in N, torques in N m, lengths in m."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator
from sher3_machines.intake.fields import Column, Description, Strict
from sher3_machines.intake.poses import Turn

Three = Column | tuple[Column, Column, Column]
"""A column of (n, 3), or three columns."""


class Load(Strict):
    """What hangs on the sensor.

    Attributes:
        mass: kg; `unknown`: identified from the readings, and a wrong scale of the sensor then cannot be told.
        centre: of mass in the sensor's frame, m; identified with an unknown mass.
    """

    mass: Annotated[float, Field(ge=0.0)] | Literal["unknown"] = "unknown"
    centre: tuple[float, float, float] = (0.0, 0.0, 0.0)


class SensorDescription(Description):
    """Static readings of a force sensor in several orientations.

    Attributes:
        force, torque: readings in the sensor's frame.
        orientation: of the sensor in a frame whose z points up, as a matrix, quaternion or Euler angles.
        load: what hangs on it.
        temperature: deg C, where it was recorded.
        noise_force, noise_torque: standard deviation of a reading, N and N m; left out: from the readings.
    """

    kind: Literal["force_sensor"]
    force: Three
    torque: Three
    orientation: Turn
    load: Load = Load()
    temperature: Column | None = None
    noise_force: float | None = Field(default=None, gt=0.0)
    noise_torque: float | None = Field(default=None, gt=0.0)

    @model_validator(mode="after")
    def _both(self) -> SensorDescription:
        if (self.noise_force is None) != (self.noise_torque is None):
            raise ValueError("state both noise_force and noise_torque, or neither")
        return self
