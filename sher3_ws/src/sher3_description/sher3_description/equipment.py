"""Typed parameters of actuators, sensors and the admittance law."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator
from typing_extensions import Self

from sher3_description.actuators import ActuatorName
from sher3_description.fields import (
    Gain,
    Inertia,
    Lead,
    Load,
    Mass,
    NonNegative,
    Number,
    Part,
    Positive,
    PositiveVector,
    Rate,
    Resolution,
    Vector,
)
from sher3_description.mechanism import refuse


class Limits(Part):
    """Travel, velocity and acceleration limits of one actuator, in its own unit (m or rad) and s."""

    lower: Annotated[Number, Field(ge=-10.0, le=10.0)]
    upper: Annotated[Number, Field(ge=-10.0, le=10.0)]
    velocity: Annotated[Number, Field(ge=1e-6, le=100.0)]
    acceleration: Annotated[Number, Field(ge=1e-6, le=1e5)]

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.lower >= self.upper:
            raise refuse("lower is not below upper", self.lower, f"< upper = {self.upper:.6g}", "swap or correct them")
        return self


class Drive(Part):
    """PI velocity controller of one drive: gains, saturation and rated force (N or N m)."""

    kp: Gain
    ki: Annotated[NonNegative, Field(le=1e9)]
    limit: Load
    rated: Load

    @model_validator(mode="after")
    def _rated_within_limit(self) -> Self:
        if self.rated > self.limit:
            raise refuse("rated exceeds limit", self.rated, f"<= limit = {self.limit:.6g}", "correct rated or limit")
        return self


class Actuator(Part):
    """One axis: its drive, its motor side reflected at the output, its encoders and its transmission."""

    name: ActuatorName
    kind: Literal["prismatic", "revolute"]
    limits: Limits
    mass: Inertia
    viscous: Annotated[NonNegative, Field(le=1e6)]
    drive: Drive
    motor_encoder: Resolution
    load_encoder: Resolution
    lead: Lead

    @model_validator(mode="after")
    def _kind_of_name(self) -> Self:
        expected = "revolute" if self.name == "roll" else "prismatic"
        if self.kind != expected:
            raise refuse(f"{self.name} has the wrong kind", self.kind, expected, "correct kind")
        return self


class ForceSensor(Part):
    """Six-axis force sensor; {f} is parallel to {t} with its origin at `position` in {t}."""

    range_force: PositiveVector
    range_torque: PositiveVector
    resolution_force: Positive
    resolution_torque: Positive
    position: Vector
    noise_force: NonNegative
    noise_torque: NonNegative
    tool_mass: Mass
    tool_com: Vector

    @model_validator(mode="after")
    def _resolves_its_range(self) -> Self:
        for name in ("force", "torque"):
            resolution, smallest = getattr(self, f"resolution_{name}"), min(getattr(self, f"range_{name}"))
            if resolution > smallest:
                what = f"resolution_{name} is coarser than range_{name}"
                raise refuse(what, resolution, f"<= {smallest:.6g}", "correct the resolution or the range")
        return self


class Tracker(Part):
    """External metrology of the tip: rate [Hz] and noise, one standard deviation [m, rad]."""

    rate: Rate
    noise_position: NonNegative
    noise_rotation: NonNegative


class Admittance(Part):
    """Admittance law: gains [(m/s)/N, (rad/s)/(N m)], deadbands [N, N m], cut-off [Hz], limits [m/s, rad/s]."""

    linear_gain: NonNegative
    angular_gain: NonNegative
    force_deadband: NonNegative
    torque_deadband: NonNegative
    filter_cutoff: Positive
    linear_limit: Annotated[Positive, Field(le=1.0)]
    angular_limit: Annotated[Positive, Field(le=10.0)]
