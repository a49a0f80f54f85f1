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


class Applied(Strict):
    """Known loads of a sensor that stays as it is: weights at levers, or wrenches; vectors are in the sensor's frame.

    Attributes:
        weight: of each reading, N, kg, gf or lbf.
        direction: which way it pulls, columns or one direction of any length for all readings.
        lever: from the sensor's origin to where it pulls, columns or one place, m.
        force, torque: known of each reading, in place of a weight: a reference sensor, or worked out beforehand.
    """

    weight: Column | None = None
    direction: Three | tuple[float, float, float] | None = None
    lever: Three | tuple[float, float, float] = (0.0, 0.0, 0.0)
    force: Three | None = None
    torque: Three | None = None

    @model_validator(mode="after")
    def _either(self) -> Applied:
        given = [x is not None for x in (self.weight, self.direction, self.force, self.torque)]
        if given not in ([True, True, False, False], [False, False, True, True]):
            raise ValueError("state either `weight` and `direction`, or both `force` and `torque`")
        return self


class SensorDescription(Description):
    """Static readings of a force sensor in several orientations, or under several weights.

    Attributes:
        force, torque: readings; the torque is about the sensor's origin.
        expressed_in: frame of the readings: the sensor's, or the upright one of `orientation`, as controllers give it.
        orientation: of the sensor in a frame whose z points up, as a matrix, quaternion or Euler angles.
        load: what hangs on it.
        applied: known weights and levers, in place of `orientation` and `load`.
        temperature: deg C, where it was recorded.
        noise_force, noise_torque: standard deviation of a reading, N and N m; left out: from the readings.
    """

    kind: Literal["force_sensor"]
    force: Three
    torque: Three
    expressed_in: Literal["sensor", "base"] = "sensor"
    orientation: Turn | None = None
    load: Load = Load()
    applied: Applied | None = None
    temperature: Column | None = None
    noise_force: float | None = Field(default=None, gt=0.0)
    noise_torque: float | None = Field(default=None, gt=0.0)

    @model_validator(mode="after")
    def _both(self) -> SensorDescription:
        if (self.noise_force is None) != (self.noise_torque is None):
            raise ValueError("state both noise_force and noise_torque, or neither")
        if (self.orientation is None) == (self.applied is None):
            raise ValueError("state either `orientation`, with what hangs on the sensor, or `applied` weights")
        if self.orientation is None and self.expressed_in == "base":
            raise ValueError("readings in the base frame need the `orientation` of the sensor")
        return self
