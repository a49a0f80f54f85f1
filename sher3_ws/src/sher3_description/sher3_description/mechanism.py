"""Typed parameters of the mechanism: delta stage, arm and tilt linkage."""

from __future__ import annotations

import math

from pydantic import model_validator
from pydantic_core import PydanticCustomError
from typing_extensions import Self

from sher3_description.fields import AngleVector, Coordinate, Length, Mass, NonNegative, Part, Positive, Vector


def refuse(what: str, value: object, limit: object, remedy: str) -> PydanticCustomError:
    """Return the error that a validator raises when a relation between keys does not hold."""
    return PydanticCustomError("geometry", "{what}", {"what": what, "value": value, "limit": limit, "remedy": remedy})


class LinkCompliance(Part):
    """Deflection of one link [m] = a |F|^b, odd in the axial force F [N]."""

    a: NonNegative
    b: Positive


class DeltaParameters(Part):
    """The linear delta stage; both radii are circumradii, from the axis to a ball centre [m]."""

    link_length: Length
    leg_width: Length
    base_radius: Length
    platform_radius: Length
    leg_azimuth: AngleVector
    slider_zero: Coordinate
    link_compliance: LinkCompliance
    spring_factor: Positive
    moving_mass: Mass

    @property
    def base_distance(self) -> float:
        """Distance [m] from the axis to the middle of a leg's pair of balls on its slider."""
        return math.sqrt(self.base_radius**2 - self.leg_width**2 / 4)

    @property
    def platform_distance(self) -> float:
        """Distance [m] from the axis to the middle of a leg's pair of balls on the platform."""
        return math.sqrt(self.platform_radius**2 - self.leg_width**2 / 4)

    @property
    def leg_offset(self) -> float:
        """Horizontal distance R [m] from the platform ball pair to the base ball pair of a leg at the centre.

        R = sqrt(r_b^2 - w^2/4) - sqrt(r_p^2 - w^2/4), recorded-run contract version 1, section 2.
        """
        return self.base_distance - self.platform_distance

    @model_validator(mode="after")
    def _constructible(self) -> Self:
        smaller = min(self.base_radius, self.platform_radius)
        if self.leg_width >= 2 * smaller:
            what = "leg_width does not fit the ball circles [m]"
            limit = f"< 2 min(base_radius, platform_radius) = {2 * smaller:.6g}"
            raise refuse(what, self.leg_width, limit, "reduce leg_width or enlarge the radii, which are circumradii")
        if not 0 < self.leg_offset < self.link_length:
            limit = f"between 0 and link_length = {self.link_length:.6g}"
            remedy = "correct base_radius, platform_radius, leg_width or link_length"
            raise refuse("the legs cannot be assembled: horizontal leg offset R [m]", self.leg_offset, limit, remedy)
        first, second, third = self.leg_azimuth
        area = math.sin(second - first) + math.sin(third - second) + math.sin(first - third)
        if abs(area) < 0.1:
            what = "leg_azimuth: the legs do not span the plane (sum of sines of their differences)"
            raise refuse(what, area, ">= 0.1 in magnitude", "spread the legs around the axis, angles in rad")
        return self


class ArmParameters(Part):
    """The serial arm behind the delta platform: roll about x, tilt about y, tool."""

    d1: Coordinate
    d2: Coordinate
    d3: Coordinate
    tool: Vector
    roll_mass: Mass
    roll_com: Vector
    tilt_mass: Mass
    tilt_com: Vector

    @model_validator(mode="after")
    def _tool_has_length(self) -> Self:
        if math.hypot(*self.tool) < 1e-6:
            raise refuse("tool has no length [m]", math.hypot(*self.tool), ">= 1e-6", "give the tip in {a}")
        return self


class TiltLinkageParameters(Part):
    """The offset slider-crank that turns the tilt slider's travel into the tilt angle [m]."""

    crank: Length
    coupler: Length
    offset: Coordinate

    @model_validator(mode="after")
    def _assembles_at_zero(self) -> Self:
        if self.coupler <= abs(self.offset - self.crank):
            limit = f"> |offset - crank| = {abs(self.offset - self.crank):.6g}"
            raise refuse(
                "coupler does not reach the crank at zero tilt [m]", self.coupler, limit, "lengthen the coupler"
            )
        return self
