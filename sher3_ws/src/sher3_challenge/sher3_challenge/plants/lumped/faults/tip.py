"""Faults behind the load encoders and in the sensors: geometry, compliance, drift, encoders, force sensor."""

from __future__ import annotations

import math
import operator

import numpy as np

from sher3_challenge.plants.declared import DELTAS
from sher3_challenge.plants.kinds import Catalogue, scaled_by, set_to
from sher3_challenge.plants.lumped.rig import Rig
from sher3_challenge.plants.lumped.tip import OUTER_HINGE
from sher3_challenge.plants.site import Site

CATALOGUE = Catalogue()
add = CATALOGUE.add
known = CATALOGUE.known

CATALOGUE.changes(
    operator.add,
    encoder_scale="truth.host.encoder_scale",
    encoder_offset="truth.host.offset",
    tool_gravity="truth.sensors.tool_mass",
)
CATALOGUE.changes(scaled_by, force_scale="truth.sensors.force_scale")
CATALOGUE.changes(set_to, tool_bending="truth.geometry.bending", thermal_expansion="truth.geometry.expansion")


@known
def encoder_eccentricity(rig: Rig, site: Site, amplitude: float) -> None:
    """The load encoder errs once per revolution; the load does not move."""
    rig.truth.host.eccentricity[site.rows] = amplitude
    rig.truth.host.eccentricity_phase[site.rows] = site.rng.uniform(0, 2 * math.pi)


@add("lost_motion", "mechanism", DELTAS, 8e-6, 5e-7, 3e-4, also=("structure",))
def joint_clearance(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Play in a leg's ball joints: it follows its slider late, or is longer in tension than in compression."""
    play = rig.truth.geometry.clearance if site.rng.random() < 0.6 else rig.truth.geometry.rattle
    play[site.index] = x
    return {"clearance": x}


@known
def structural_compliance(rig: Rig, site: Site, fraction: float) -> None:
    """The structure turns about P and, in part, about a hinge on the arm; `fraction` is that of the measured one."""
    share, arm = 0.3, rig.truth.geometry.arm[1]
    weight = 1 - share + share * (1 - OUTER_HINGE / arm) ** 2  # keeps the tip's compliance that of one hinge at P
    rig.truth.geometry.hinge[:] = fraction * np.array([15e-6, 0.0, 1 / 244 / weight, 1 / 213 / weight, 0.0, 0.0])
    rig.truth.geometry.hinge[4] = share


@known
def link_compliance(rig: Rig, site: Site, fraction: float) -> None:
    """The six links give way by their published law; `fraction` is that of it."""
    delta = rig.robot.delta
    rig.truth.geometry.link_law[0] = fraction * delta.link_compliance.a * delta.spring_factor


@known
def structural_vibration(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A mode of the structure rings when the tip accelerates, in y or z."""
    frequency, damping = site.rng.uniform(8.0, 22.0), site.rng.uniform(0.02, 0.08)
    rig.truth.geometry.vibration[:4] = x, frequency, damping, site.rng.choice([1, 2])
    return {"frequency": frequency, "damping": damping, "gain": x}


@known
def link_length_error(rig: Rig, site: Site, length: float) -> None:
    """Both links of a leg are longer or shorter."""
    rig.truth.geometry.link[2 * site.index : 2 * site.index + 2] += length


@known
def platform_geometry_error(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The balls of a leg on the platform sit elsewhere in its plane, the two not quite alike."""
    angle, unlike = site.rng.uniform(0, 2 * math.pi), site.rng.uniform(-0.15, 0.15)
    offset = x * np.array([math.cos(angle), math.sin(angle), 0.0])
    balls = rig.truth.geometry.platform_ball
    balls[2 * site.index] += (1 + unlike) * offset
    balls[2 * site.index + 1] += (1 - unlike) * offset
    return {"x": offset[0], "y": offset[1]}


@known
def rail_tilt(rig: Rig, site: Site, x: float, y: float, angle: float) -> None:
    """A rail leans."""
    lean = np.array([x, y, 0.0])
    rail = rig.truth.geometry.rail
    rail[site.index] += lean
    rail[site.index] /= np.linalg.norm(rail[site.index])


@known
def base_tilt(rig: Rig, site: Site, x: float, y: float, angle: float) -> None:
    """The base leans against the tracker."""
    rig.truth.geometry.base_tilt[:] += x, y, 0.0


@known
def tilt_linkage_error(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Crank, coupler or offset of the tilt linkage differs; the axis is homed at zero tilt."""
    which, length = int(site.rng.integers(3)), site.sign() * x
    g = rig.truth.geometry
    g.linkage[which] += length
    crank, coupler, offset = g.linkage
    g.linkage_zero[0] = math.sqrt(coupler**2 - (offset - crank) ** 2)
    return {("crank", "coupler", "offset")[which]: length, "length": length}


@known
def tool_offset(rig: Rig, site: Site, x: float, y: float, z: float) -> None:
    """The tool's tip is elsewhere."""
    rig.truth.geometry.arm[3:] += x, y, z


@known
def force_drift(rig: Rig, site: Site, fx: float, fy: float, fz: float) -> None:
    """The force sensor's zero moves with temperature."""
    rig.truth.sensors.force_drift[:3] = fx, fy, fz


@known
def force_bias(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The force sensor's zero is off."""
    bias = x * site.direction()
    rig.truth.sensors.force_bias[:3] += bias
    rig.truth.sensors.force_bias[3:] += 0.01 * x * site.direction()
    return dict(zip(("fx", "fy", "fz"), bias.tolist(), strict=True))


@known
def force_crosstalk(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A force along one axis of the sensor shows on another."""
    row, column = site.rng.choice(3, 2, replace=False)
    coefficient = site.sign() * x
    rig.truth.sensors.crosstalk[row, column] += coefficient
    return {"coefficient": coefficient}


@known
def cable_drag_sensor(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A cable pulls at the sensor as roll and tilt turn, with hysteresis in roll; `x` is N per rad."""
    rig.truth.sensors.cable_force[:] = x, 0.7 * x, 0.08 * x, 0.05
    return {"stiffness": x, "force": 0.08 * x}
