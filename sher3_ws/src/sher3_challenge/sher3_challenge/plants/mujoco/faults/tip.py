"""Faults behind the load encoders: geometry, play, compliance, drift, force sensor."""

from __future__ import annotations

import math
import operator

import numpy as np

from sher3_challenge.plants.declared import DELTAS
from sher3_challenge.plants.kinds import Catalogue
from sher3_challenge.plants.mujoco.faults.axis import bristles
from sher3_challenge.plants.mujoco.rig import Rig, Spring
from sher3_challenge.plants.mujoco.tip import ALONG_X, PITCH, YAW
from sher3_challenge.plants.site import Site

CATALOGUE = Catalogue()
add = CATALOGUE.add
known = CATALOGUE.known

CATALOGUE.changes(
    operator.add,
    link_compliance="yielding.links",  # seated by a preload
    thermal_expansion="mechanism.expansion",  # some seconds behind the thermometer
    tool_gravity="sensor.tool_mass",
)
RUBBING = 0.015
"""Friction of a spring of the structure, as a share of what one newton at its usual lever does."""


@add("lost_motion", "mechanism", (*DELTAS, "tilt"), 8e-6, 5e-7, 3e-4, also=("structure",))
def joint_clearance(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Play behind the load encoder: what the slider moves is pushed from one side to the other."""
    rig.axes[site.index].leg_gap += x
    return {"clearance": x}


@known
def structural_compliance(rig: Rig, site: Site, fraction: float) -> None:
    """Springs at P that carry a mass and rub; `fraction` is that of the measured compliance."""
    springs = (
        Spring("x", fraction * ALONG_X, 55.0, rub=RUBBING), Spring("turn_y", fraction / PITCH, 38.0, rub=0.2 * RUBBING),
        Spring("turn_z", fraction / YAW, 42.0, rub=0.2 * RUBBING),
    )  # fmt: skip
    rig.yielding.springs += springs


@known
def tool_bending(rig: Rig, site: Site, compliance: float) -> None:
    """The tool bends across its axis, on a mass that swings."""
    rig.yielding.springs += (
        Spring("across_x", compliance, 60.0, rub=RUBBING),
        Spring("across_y", compliance, 60.0, rub=RUBBING),
    )
    rig.yielding.slope = 1.5 / abs(rig.robot.arm.tool[2])


@known
def structural_vibration(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A mass on a spring rings, and rubs, when the tip accelerates in y or z."""
    frequency, damping = float(site.rng.uniform(8.0, 22.0)), float(site.rng.uniform(0.02, 0.08))
    way = str(site.rng.choice(["mode_y", "mode_z"]))
    omega = 2 * math.pi * frequency
    rig.yielding.springs += (Spring(way, x / omega**2, frequency, damping, rub=2e-3),)
    return {"frequency": frequency, "damping": damping, "amplitude": x}


@known
def link_length_error(rig: Rig, site: Site, length: float) -> None:
    """Both links of a leg are longer or shorter, not quite alike."""
    unlike = float(site.rng.uniform(-0.1, 0.1))
    rig.mechanism.link[2 * site.index] += (1 + unlike) * length
    rig.mechanism.link[2 * site.index + 1] += (1 - unlike) * length


@known
def platform_geometry_error(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The balls of a leg on the platform are displaced together in its plane."""
    angle = float(site.rng.uniform(0, 2 * math.pi))
    offset = x * np.array([math.cos(angle), math.sin(angle), 0.0])
    rig.mechanism.platform_ball[2 * site.index : 2 * site.index + 2] += offset
    return {"x": offset[0], "y": offset[1]}


@known
def rail_tilt(rig: Rig, site: Site, x: float, y: float, angle: float) -> None:
    """A rail leans; its scale goes with it."""
    rail = rig.mechanism.rail[site.index] + [x, y, 0.0]
    rig.mechanism.rail[site.index] = rail / np.linalg.norm(rail)


@known
def base_tilt(rig: Rig, site: Site, x: float, y: float, angle: float) -> None:
    """The base leans against the tracker."""
    rig.mechanism.base_turn += x, y, 0.0


@known
def tilt_linkage_error(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Crank, coupler or offset of the tilt linkage differs; the axis is homed at zero tilt."""
    which, length = int(site.rng.integers(3)), site.sign() * x
    rig.mechanism.linkage[which] += length
    return {("crank", "coupler", "offset")[which]: length, "length": length}


@known
def tool_offset(rig: Rig, site: Site, x: float, y: float, z: float) -> None:
    """The tool's tip is elsewhere."""
    rig.mechanism.arm[3:] += x, y, z


@known
def force_drift(rig: Rig, site: Site, fx: float, fy: float, fz: float) -> None:
    """The force sensor's zero moves with temperature."""
    rig.sensor.drift = np.array([fx, fy, fz, 0.0, 0.0, 0.0])


@known
def force_bias(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The force sensor's zero is off, of forces and moments."""
    bias = x * site.direction()
    rig.sensor.bias = rig.sensor.bias + np.array([*bias, *(0.01 * x * site.direction())])
    return dict(zip(("fx", "fy", "fz"), bias.tolist(), strict=True))


@known
def force_scale(rig: Rig, site: Site, relative: float) -> None:
    """The force sensor's gain is off."""
    rig.sensor.matrix = (1 + relative) * rig.sensor.matrix


@known
def force_crosstalk(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A force along one axis of the sensor shows on another."""
    row, column = site.rng.choice(3, 2, replace=False)
    coefficient = site.sign() * x
    rig.sensor.matrix[row, column] += coefficient
    return {"coefficient": coefficient}


@known
def cable_drag_sensor(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A cable pulls at the sensor as roll and tilt turn, and drags in roll; `x` is N per rad."""
    rig.sensor.cable = np.array([x, 0.7 * x])
    rig.sensor.cable_bristles = bristles(0.08 * x, 0.05)
    return {"stiffness": x, "force": 0.08 * x, "displacement": 0.05}
