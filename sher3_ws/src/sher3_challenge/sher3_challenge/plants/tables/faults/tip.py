"""Faults behind the load encoders and in the sensors: geometry, compliance, drift, encoders, force sensor."""

from __future__ import annotations

import math
import operator

import numpy as np

from sher3_challenge.plants.declared import DELTAS
from sher3_challenge.plants.kinds import Catalogue, set_to
from sher3_challenge.plants.site import Site
from sher3_challenge.plants.tables.curves import CURVE, RING, ring, wobble
from sher3_challenge.plants.tables.mechanism import angle_table
from sher3_challenge.plants.tables.plant import Rig
from sher3_challenge.plants.tables.robot import SPRINGS

CATALOGUE = Catalogue()
add = CATALOGUE.add
known = CATALOGUE.known

CATALOGUE.changes(
    operator.add,
    encoder_scale="truth.host.scale",
    encoder_offset="truth.host.offset",
    link_length_error="truth.mechanism.length",
    thermal_expansion="truth.tip.expansion",  # of a body that lags behind the thermometer
)
CATALOGUE.changes(set_to, tool_bending="truth.tip.bending")  # hardens


@known
def encoder_eccentricity(rig: Rig, site: Site, amplitude: float) -> None:
    """The load encoder errs once per revolution, on a disc that is not quite round; the load does not move."""
    turn = 2 * math.pi * np.arange(RING) / RING
    wave = np.sin(turn + site.rng.uniform(0, 2 * math.pi)) + 0.2 * np.sin(2 * turn + site.rng.uniform(0, 6))
    rig.truth.host.eccentricity[site.rows] += amplitude * (wave + 0.08 * ring(site.rng))


@add("lost_motion", "mechanism", (*DELTAS, "tilt"), 8e-6, 5e-7, 3e-4, also=("structure",))
def joint_clearance(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Play behind the load encoder: a joint follows its slider late, or a leg's links rest by the force in them."""
    tip = rig.truth.tip
    if site.actuator == "tilt":
        tip.follow[3] = x
    elif site.rng.random() < 0.5:
        tip.follow[site.index] = x
    else:
        tip.rattle[site.index] = x
    return {"clearance": x}


@known
def structural_compliance(rig: Rig, site: Site, fraction: float) -> None:
    """The arm turns about the platform and bends; `fraction` is that of the published compliance."""
    rig.truth.tip.spring[:] += fraction * SPRINGS


@known
def link_compliance(rig: Rig, site: Site, fraction: float) -> None:
    """The six links give way by their published law, sampled, no two alike; `fraction` is the mean."""
    rig.truth.tip.link_law[:] = fraction * (1 + 0.12 * site.rng.standard_normal(6))


@known
def structural_vibration(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A mode of the structure rings when the tip accelerates, and a second, higher one a little."""
    frequency, damping = site.rng.uniform(8.0, 22.0), site.rng.uniform(0.02, 0.08)
    axis = site.rng.choice([1, 2])
    second = site.rng.uniform(2.1, 2.9) * frequency
    rig.truth.tip.modes[:] = [[frequency, damping, x], [second, 0.7 * damping, 1.6 * x]]
    rig.truth.tip.mode_axis[:] = axis, axis
    return {"frequency": frequency, "damping": damping, "gain": x}


@known
def platform_geometry_error(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The balls of a leg on the platform sit elsewhere in its plane, and a little out of it."""
    angle = site.rng.uniform(0, 2 * math.pi)
    offset = x * np.array([math.cos(angle), math.sin(angle), 0.15 * site.sign()])
    rig.truth.mechanism.centre[site.index] -= offset
    return {"x": offset[0], "y": offset[1]}


@known
def rail_tilt(rig: Rig, site: Site, x: float, y: float, angle: float) -> None:
    """A rail leans, and is not quite straight."""
    g = rig.truth.mechanism
    lean = np.array([x, y, 0.0])
    g.rail[site.index] += lean
    g.rail[site.index] /= np.linalg.norm(g.rail[site.index])
    g.bow[site.index] += 0.06 * 4e-3 * lean[:2, None] * (wobble(site.rng, 1.0) - 1.0)


@known
def base_tilt(rig: Rig, site: Site, x: float, y: float, angle: float) -> None:
    """The base leans against the tracker."""
    rig.truth.tip.base_tilt[:] += x, y, 0.0


@known
def tilt_linkage_error(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Crank, coupler or offset of the tilt linkage differs; the axis is homed at zero tilt."""
    which, length = int(site.rng.integers(3)), site.sign() * x
    g = rig.truth.mechanism
    g.linkage[which] += length
    g.angle[:] = angle_table(g.linkage, g.travel)
    return {("crank", "coupler", "offset")[which]: length, "length": length}


@known
def tool_offset(rig: Rig, site: Site, x: float, y: float, z: float) -> None:
    """The tool's tip is elsewhere."""
    rig.truth.mechanism.arm[3:] += x, y, z


@known
def force_drift(rig: Rig, site: Site, fx: float, fy: float, fz: float) -> None:
    """The force sensor's zero moves with its body's temperature."""
    rig.truth.sensor.drift[:3] += fx, fy, fz


@known
def force_bias(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The force sensor's zero is off."""
    bias = x * site.direction()
    rig.truth.sensor.bias[:3] += bias
    rig.truth.sensor.bias[3:] += 0.01 * x * site.direction()
    return dict(zip(("fx", "fy", "fz"), bias.tolist(), strict=True))


@known
def tool_gravity(rig: Rig, site: Site, mass: float) -> None:
    """The tool on the sensor is heavier or lighter than its data, and its centre elsewhere by a millimetre's part."""
    rig.truth.sensor.tool_mass[0] += mass
    rig.truth.sensor.tool_com[:] += 1e-3 * site.direction() * min(1.0, abs(mass) / 0.01)


@known
def force_scale(rig: Rig, site: Site, relative: float) -> None:
    """The force sensor's gain is off, on no two channels quite alike."""
    rig.truth.sensor.matrix[:] *= 1 + relative * (1 + 0.12 * site.rng.standard_normal((6, 1)))


@known
def force_crosstalk(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A force along one axis of the sensor shows on another, less in proportion at large forces."""
    row, column = site.rng.choice(3, 2, replace=False)
    coefficient = site.sign() * x
    rig.truth.sensor.matrix[row, column] += coefficient / 0.85
    rig.truth.sensor.saturation[0] = 0.35
    return {"coefficient": coefficient}


@known
def cable_drag_sensor(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A cable pulls at the sensor as roll and tilt turn, the harder the more it is bent; `x` is N per rad."""
    s, u = rig.truth.sensor, np.linspace(-1.0, 1.0, CURVE)
    s.cable[0] += x * (0.85 * u + 0.9 * u**3 + 0.02 * (wobble(site.rng, 1.0) - 1))
    s.cable[1] += 0.7 * x * (0.85 * u + 0.9 * u**3 + 0.02 * (wobble(site.rng, 1.0) - 1))
    s.cable_loop[:] = 0.08 * x, 0.04
    return {"stiffness": x, "force": 0.08 * x}
