"""A mechanism that is not as drawn."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from sher3_description import ACTUATORS

from sher3_sim.effects.base import SLIDERS, Effect, parameter
from sher3_sim.parameters import PlantParameters


def _length(default: float, text: str) -> Any:
    return parameter("m", default, -5e-3, 5e-3, text, fixed_unit=True)


def _angle(default: float, text: str, limit: float = 0.1) -> Any:
    return parameter("rad", default, -limit, limit, text, fixed_unit=True)


def shift(p: PlantParameters, **changes: float) -> None:
    """Add to values of the true mechanism's geometry."""
    p.geometry = p.geometry._replace(**{name: getattr(p.geometry, name) + by for name, by in changes.items()})


@dataclass(frozen=True)
class LinkLengthError(Effect, id="link_length_error", family="geometry", stage="mechanism", places=SLIDERS):
    """The two links of one leg are longer than drawn; where they also differ, the platform turns."""

    length: float = _length(20e-6, "mean length of the pair less nominal")
    difference: float = _length(0.0, "second link, towards growing azimuth, less the first")

    def apply(self, p: PlantParameters) -> None:
        """Lengthen the links."""
        shift(p, **{f"link_{self.rows[0] + 1}": self.length})
        p.body["link_difference"][0, self.rows] += self.difference
        p.body["gives_way"] |= self.difference != 0.0


@dataclass(frozen=True)
class PlatformGeometryError(Effect, id="platform_geometry_error", family="geometry", stage="mechanism", places=SLIDERS):
    """The ball joints of one leg sit elsewhere on the platform than drawn, radially and tangentially."""

    x: float = _length(20e-6, "outwards, along the leg's azimuth")
    y: float = _length(0.0, "sideways, towards growing azimuth")

    def apply(self, p: PlantParameters) -> None:
        """Move the platform ball pair: the leg's anchor is the base pair less the platform pair."""
        leg = self.rows[0] + 1
        c, s = _direction(p, self.rows[0])
        shift(p, **{f"anchor_{leg}x": -(c * self.x - s * self.y), f"anchor_{leg}y": -(s * self.x + c * self.y)})


@dataclass(frozen=True)
class RailTilt(Effect, id="rail_tilt", family="geometry", stage="mechanism", places=SLIDERS):
    """A rail is not vertical: it leans by an angle, towards a direction seen from the leg's azimuth."""

    angle: float = _angle(1e-3, "lean from the vertical")
    azimuth: float = _angle(0.0, "of the lean, from outwards towards growing azimuth", 7.0)

    def apply(self, p: PlantParameters) -> None:
        """Lean the rail's direction."""
        leg = self.rows[0] + 1
        towards = p.robot.delta.leg_azimuth[self.rows[0]] + self.azimuth
        lean = math.sin(self.angle)
        shift(p, **{f"rail_{leg}x": lean * math.cos(towards), f"rail_{leg}y": lean * math.sin(towards)})


@dataclass(frozen=True)
class BaseTilt(Effect, id="base_tilt", family="geometry", stage="mechanism", places=("tip", "all")):
    """The whole robot stands tilted in the frame in which its tip is measured."""

    x: float = _angle(1e-3, "rotation about x of {b}")
    y: float = _angle(0.0, "rotation about y of {b}")

    def apply(self, p: PlantParameters) -> None:
        """Rotate the base."""
        shift(p, base_x=self.x, base_y=self.y)


@dataclass(frozen=True)
class TiltLinkageError(Effect, id="tilt_linkage_error", family="geometry", stage="mechanism", places=("tilt",)):
    """The crank, the coupler or the offset of the tilt linkage is not as drawn: the ratio changes along the travel."""

    length: float = _length(50e-6, "coupler less nominal")
    crank: float = _length(0.0, "crank less nominal")
    offset: float = _length(0.0, "offset less nominal")

    def apply(self, p: PlantParameters) -> None:
        """Change the linkage; zero of the slider stays where the nominal linkage has zero angle."""
        nominal = p.robot.tilt_linkage
        shift(p, coupler=self.length, crank=self.crank, offset=self.offset)
        g = p.geometry
        built = math.sqrt(g.coupler**2 - (g.offset - g.crank) ** 2)
        drawn = math.sqrt(nominal.coupler**2 - (nominal.offset - nominal.crank) ** 2)
        shift(p, zero_5=drawn - built)


@dataclass(frozen=True)
class ToolOffset(Effect, id="tool_offset", family="geometry", stage="mechanism", places=("tip",)):
    """The tip is not where the tool is drawn to end."""

    x: float = _length(50e-6, "along x of {t}")
    y: float = _length(0.0, "along y of {t}")
    z: float = _length(0.0, "along z of {t}")

    def apply(self, p: PlantParameters) -> None:
        """Move the tip."""
        shift(p, tool_x=self.x, tool_y=self.y, tool_z=self.z)


@dataclass(frozen=True)
class EncoderOffset(Effect, id="encoder_offset", family="geometry", stage="mechanism", places=ACTUATORS):
    """A homing error: both encoders of the axis read too much by the offset."""

    offset: float = parameter("m", 20e-6, -5e-3, 5e-3, "reading less true position")

    def apply(self, p: PlantParameters) -> None:
        """Shift both readings."""
        p.axis["encoder_offset"][self.rows] += self.offset


def _direction(p: PlantParameters, leg: int) -> tuple[float, float]:
    azimuth = p.robot.delta.leg_azimuth[leg]
    return math.cos(azimuth), math.sin(azimuth)
