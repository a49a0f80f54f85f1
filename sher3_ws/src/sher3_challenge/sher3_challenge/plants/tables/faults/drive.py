"""Faults between the host and the load encoder, friction left out: timing, scale, limit, inertia, periodic, lost."""

from __future__ import annotations

import math
import operator

import numpy as np
from sher3_description.contract import GRAVITY

from sher3_challenge.plants.declared import DELTAS
from sher3_challenge.plants.kinds import Catalogue, scaled_by, set_to
from sher3_challenge.plants.site import Site
from sher3_challenge.plants.tables.curves import CURVE, ring, teeth, wobble
from sher3_challenge.plants.tables.plant import Rig

CATALOGUE = Catalogue()
known = CATALOGUE.known

CATALOGUE.changes(
    operator.add,
    command_delay="transport.delay",  # wavers
    axis_skew="transport.delay",
    drive_lag="truth.drive.lag",  # of two equal poles: their sum
)
CATALOGUE.changes(scaled_by, controller_gain="truth.host.gain")
CATALOGUE.changes(
    set_to,
    command_jitter="transport.lateness",  # its rms, as on a busy bus: seldom punctual, sometimes very late
    dropped_commands="transport.loss",  # often a few in a row
    velocity_deadband="truth.drive.band",  # with a rounded edge
)


@known
def torque_constant(rig: Rig, site: Site, relative: float) -> None:
    """Real force over reported effort is not 1, and bends: less at large forces than at small ones."""
    bend = site.rng.uniform(0.5, 1.0)
    load = np.linspace(0.0, 1.0, CURVE)
    rig.truth.motor.force_gain[site.rows] *= 1 + relative * (1 + bend * (0.15 - load))


@known
def lead_error(rig: Rig, site: Site, relative: float) -> None:
    """The load travels more or less than the motor, and not evenly along the stroke."""
    t = rig.truth.transmission
    t.ratio[site.rows] += relative
    t.wave[site.rows] += 0.09 * relative * rig.truth.motor.span[site.rows][:, None] * ring(site.rng, 0.12)


@known
def force_saturation(rig: Rig, site: Site, limit: float) -> None:
    """The force bends from 80 % of its limit on and ends there: at a share of 12 N, more on roll."""
    rig.truth.drive.limit[site.rows] = limit
    rig.truth.drive.soft[site.rows] = 1.0


@known
def payload_mass(rig: Rig, site: Site, mass: float) -> None:
    """Mass on an elastic mount; on the vertical rails its weight too."""
    frequency = site.rng.uniform(35.0, 60.0)
    m, omega = rig.truth.motor, 2 * math.pi * frequency
    m.mount_mass[site.rows] = mass
    m.mount_stiffness[site.rows] = mass * omega**2
    m.mount_damping[site.rows] = 2 * 0.1 * mass * omega
    m.mount_weight[site.rows] = GRAVITY * mass if site.actuator in DELTAS else 0.0


@known
def gravity_load(rig: Rig, site: Site, mass: float) -> None:
    """Weight without inertia, near the pattern of the axis's own gravity: its centre is not quite the same."""
    carried = rig.truth.mechanism.masses[2] if site.actuator == "tilt" else rig.truth.mechanism.masses[0]
    rig.truth.motor.gravity_gain[site.rows] += mass / carried * wobble(site.rng, 0.06)


@known
def cogging(rig: Rig, site: Site, amplitude: float, periods_per_rev: float) -> None:
    """Force in phase with the motor's poles, every one a little different."""
    wave = teeth(site.rng, periods_per_rev, site.rng.uniform(0, 2 * math.pi), site.rng.uniform(0.2, 0.38))
    rig.truth.motor.cogging[site.rows] += amplitude * wave


@known
def transmission_ripple(rig: Rig, site: Site, amplitude: float, periods_per_rev: float) -> None:
    """The load runs ahead and behind with the motor's turn, as a gear's test record shows it."""
    wave = teeth(site.rng, periods_per_rev, site.rng.uniform(0, 2 * math.pi), site.rng.uniform(0.2, 0.38))
    rig.truth.transmission.ripple[site.rows] += amplitude * wave


@known
def backlash(rig: Rig, site: Site, width: float) -> None:
    """A gap with elastic, damped flanks; behind it a light carriage with friction of its own.

    `width` is what is lost between the two directions: the gap and what its flanks give way under that friction.
    """
    t = rig.truth.transmission
    brake, hardest = t.brake[site.rows], t.contact[site.rows].copy()
    t.contact[site.rows] = np.clip(brake / (0.12 * width), 0.1 * hardest, hardest)
    t.gap[site.rows] = np.maximum(0.2 * width, width - 2 * brake / t.contact[site.rows])


@known
def transmission_hysteresis(rig: Rig, site: Site, width: float) -> dict[str, float]:
    """Lost motion that builds up after a reversal along a measured loop."""
    half, reach = width / 2, site.scaled(site.rng.uniform(25e-6, 120e-6), "length")
    rig.truth.transmission.hysteresis[site.rows] = half
    rig.truth.transmission.hysteresis_reach[site.rows] = reach
    return {"displacement": reach}


@known
def transmission_compliance(rig: Rig, site: Site, compliance: float, stiffness: float) -> None:
    """A screw that winds up and stiffens with its force, three tenths of the mass behind it."""
    t, load = rig.truth.transmission, np.linspace(0.0, 1.0, CURVE)
    t.compliance[site.rows] = compliance
    t.stiffening[site.rows] = (0.85 + site.rng.uniform(0.8, 1.6) * load) * wobble(site.rng, 0.02)


@known
def cable_drag_axis(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A cable pulls an axis back, harder the more it is bent, with hysteresis; `x` is its force a millimetre away."""
    force, stroke = site.scaled(x, "force"), site.scaled(1e-3, "length")
    m, u = rig.truth.motor, np.linspace(-1.0, 1.0, CURVE)
    span = 8.0
    m.cable_span[site.rows] = span * stroke
    m.cable[site.rows] = force * span * (0.8 * u + 2.5 * u**3) * wobble(site.rng, 0.03)
    m.cable_rest[site.rows] = site.rng.uniform(-0.5, 0.5) * stroke
    m.cable_loop[site.rows], m.cable_reach[site.rows] = 0.6 * force, 0.3 * stroke
    return {"stiffness": force / stroke, "force": 0.6 * force}
