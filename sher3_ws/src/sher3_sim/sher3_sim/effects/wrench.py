"""What the force sensor reads, or an axis feels, beside the contact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sher3_description import ACTUATORS

from sher3_sim.effects.base import Effect, parameter
from sher3_sim.parameters import PlantParameters

_SENSOR = ("force_sensor",)


@dataclass(frozen=True)
class ForceBias(Effect, id="force_bias", family="wrench", stage="sensing", places=_SENSOR):
    """The force sensor's zero is off by a constant in its own frame."""

    fx: float = parameter("N", 0.05, -12.0, 12.0, "along x of {f}")
    fy: float = parameter("N", 0.0, -12.0, 12.0, "along y of {f}")
    fz: float = parameter("N", 0.0, -17.0, 17.0, "along z of {f}")
    tx: float = parameter("N m", 0.0, -0.12, 0.12, "about x of {f}")
    ty: float = parameter("N m", 0.0, -0.12, 0.12, "about y of {f}")
    tz: float = parameter("N m", 0.0, -0.12, 0.12, "about z of {f}")

    def apply(self, p: PlantParameters) -> None:
        """Add the bias."""
        p.body["wrench_bias"][0] += (self.fx, self.fy, self.fz, self.tx, self.ty, self.tz)


@dataclass(frozen=True)
class ToolGravity(Effect, id="tool_gravity", family="wrench", stage="sensing", places=_SENSOR):
    """The tool outboard of the sensor is heavier than thought, or its centre of mass lies elsewhere."""

    mass: float = parameter("kg", 5e-3, -0.02, 0.5, "tool mass less nominal")
    x: float = parameter("m", 0.0, -0.1, 0.1, "centre of mass less nominal, along x of {f}")
    y: float = parameter("m", 0.0, -0.1, 0.1, "centre of mass less nominal, along y of {f}")
    z: float = parameter("m", 0.0, -0.1, 0.1, "centre of mass less nominal, along z of {f}")

    def apply(self, p: PlantParameters) -> None:
        """Change the tool's weight."""
        p.body["tool_mass"] += self.mass
        p.body["tool_com"][0] += (self.x, self.y, self.z)


def _coupling(pair: str, default: float = 0.0) -> Any:
    return parameter("1", default, -0.5, 0.5, f"share of the force along {pair[1]} read along {pair[0]}")


@dataclass(frozen=True)
class ForceCrosstalk(Effect, id="force_crosstalk", family="wrench", stage="sensing", places=_SENSOR):
    """A force along one axis of the sensor is read along another as well."""

    xy: float = _coupling("xy")
    xz: float = _coupling("xz", 0.03)
    yx: float = _coupling("yx")
    yz: float = _coupling("yz")
    zx: float = _coupling("zx")
    zy: float = _coupling("zy")

    def apply(self, p: PlantParameters) -> None:
        """Add to the sensor's matrix."""
        for name, value in self.parameters.items():
            p.body["wrench_matrix"][0, "xyz".index(name[0]), "xyz".index(name[1])] += value


@dataclass(frozen=True)
class CableDrag(Effect, id="cable_drag", family="wrench", stage="motor_mechanics", places=(*ACTUATORS, *_SENSOR)):
    """A cable pulls back, as a spring along the travel and a hysteretic drag; on an axis or on the force sensor."""

    stiffness: float = parameter("N/m", 20.0, 0.0, 5000.0, "force per displacement")
    force: float = parameter("N", 0.1, 0.0, 20.0, "hysteretic part")
    displacement: float = parameter("m", 1e-3, 1e-6, 0.05, "over which the hysteretic part turns to 1/e")

    def apply(self, p: PlantParameters) -> None:
        """Attach the cable."""
        if self.actuator == "force_sensor":
            p.body["sensor_cable_stiffness"] += self.stiffness
            p.body["sensor_cable_force"] += self.force
            p.body["sensor_cable_displacement"] = self.displacement
        else:
            p.axis["cable_stiffness"][self.rows] += self.stiffness
            p.axis["cable_force"][self.rows] += self.force
            p.axis["cable_displacement"][self.rows] = self.displacement
