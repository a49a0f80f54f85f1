"""Faults between the host and the load: timing, limits, scale, friction, inertia, periodic and lost motion."""

from __future__ import annotations

import math
import operator

from sher3_description.contract import GRAVITY

from sher3_challenge.plants.declared import DELTAS
from sher3_challenge.plants.kinds import Catalogue, scaled_by, set_to
from sher3_challenge.plants.lumped.rig import Rig
from sher3_challenge.plants.site import Site

CATALOGUE = Catalogue()
known = CATALOGUE.known

CATALOGUE.changes(
    operator.add,
    command_delay="timing.delay",
    axis_skew="timing.delay",
    lead_error="truth.transmission.lead_error",
    viscous_friction="truth.motor.viscous",
)
CATALOGUE.changes(scaled_by, controller_gain="truth.host.gain", torque_constant="truth.motor.torque_gain")
CATALOGUE.changes(
    set_to,
    command_jitter="timing.jitter",
    dropped_commands="timing.loss",
    force_saturation="truth.drive.limit",
    backlash="truth.transmission.backlash",
)


@known
def drive_lag(rig: Rig, site: Site, time_constant: float) -> None:
    """A first-order lag of the force (three of four) or of the demand."""
    lag = rig.truth.drive.current_lag if site.rng.random() < 0.75 else rig.truth.drive.demand_lag
    lag[site.rows] += time_constant


@known
def velocity_deadband(rig: Rig, site: Site, width: float) -> None:
    """Small demands do nothing; in a third of the cases the larger ones are shortened too."""
    rig.truth.drive.deadband[site.rows] = width
    rig.truth.drive.deadband_soft[site.rows] = float(site.rng.random() < 1 / 3)


@known
def coulomb_friction(rig: Rig, site: Site, force: float) -> None:
    """Friction of one level."""
    rig.truth.motor.coulomb[site.rows] += force
    rig.truth.motor.static[site.rows] += force


@known
def stribeck_friction(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Friction that falls with speed."""
    static, level = site.scaled(x, "force"), site.rng.uniform(0.1, 0.4)
    velocity = site.scaled(site.rng.uniform(4e-4, 1.6e-3), "speed")
    rig.truth.motor.static[site.rows] += static
    rig.truth.motor.coulomb[site.rows] += level * static
    rig.truth.motor.stribeck_velocity[site.rows] = velocity
    return {"static": static, "force": level * static, "velocity": velocity}


@known
def presliding_friction(rig: Rig, site: Site, force: float) -> dict[str, float]:
    """Friction that takes tens of micrometres to build up."""
    reach = site.scaled(site.rng.uniform(25e-6, 110e-6), "length")
    rig.truth.motor.coulomb[site.rows] += force
    rig.truth.motor.static[site.rows] += force
    rig.truth.motor.presliding[site.rows] = reach
    return {"displacement": reach}


@known
def position_friction(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Friction that waxes and wanes along the stroke, down to none."""
    amplitude, period = site.scaled(x, "force"), site.scaled(site.rng.uniform(0.8e-3, 2.6e-3), "length")
    m = rig.truth.motor
    m.friction_wave[site.rows], m.friction_period[site.rows] = amplitude, period
    m.friction_phase[site.rows] = site.rng.uniform(0, 2 * math.pi)
    return {"force": amplitude / 2, "amplitude": amplitude / 2, "period": period}


@known
def friction_drift(rig: Rig, site: Site, force: float, time_constant: float) -> None:
    """Friction after standing, which runs in within seconds."""
    rig.truth.motor.friction_fading[site.rows] = force
    rig.truth.motor.friction_time[site.rows] = time_constant


@known
def payload_mass(rig: Rig, site: Site, mass: float) -> None:
    """Mass on an axis; on the vertical rails its weight too, of a mass on the slider or on the platform."""
    rig.truth.motor.mass[site.rows] += mass
    if site.actuator in DELTAS:
        if site.rng.random() < 0.5:
            rig.truth.motor.weight[site.rows] += GRAVITY * mass
        else:
            rig.truth.motor.gravity_gain[site.rows] += mass / rig.truth.geometry.masses[0]


@known
def gravity_load(rig: Rig, site: Site, mass: float) -> None:
    """Weight without inertia, in the pattern of the axis's own gravity."""
    carried = rig.truth.geometry.masses[2] if site.actuator == "tilt" else rig.truth.geometry.masses[0]
    rig.truth.motor.gravity_gain[site.rows] += mass / carried


@known
def cogging(rig: Rig, site: Site, amplitude: float, periods_per_rev: float) -> None:
    """Force in phase with the motor's poles."""
    m = rig.truth.motor
    m.cogging[site.rows], m.cogging_order[site.rows] = amplitude, periods_per_rev
    m.cogging_phase[site.rows] = site.rng.uniform(0, 2 * math.pi)


@known
def transmission_ripple(rig: Rig, site: Site, amplitude: float, periods_per_rev: float) -> None:
    """The load runs ahead and behind with the motor's turn."""
    t = rig.truth.transmission
    t.ripple[site.rows], t.ripple_order[site.rows] = amplitude, periods_per_rev
    t.ripple_phase[site.rows] = site.rng.uniform(0, 2 * math.pi)


@known
def transmission_hysteresis(rig: Rig, site: Site, width: float) -> dict[str, float]:
    """Lost motion that builds up gradually after a reversal."""
    half, reach = width / 2, site.scaled(site.rng.uniform(40e-6, 200e-6), "length")
    rig.truth.transmission.hysteresis[site.rows] = half
    rig.truth.transmission.hysteresis_reach[site.rows] = reach
    return {"displacement": reach}


@known
def transmission_compliance(rig: Rig, site: Site, compliance: float, stiffness: float) -> None:
    """A screw that gives way, more where its free length is longer, with the load's mass behind it."""
    rig.truth.transmission.compliance[site.rows] = compliance
    slope = site.rng.uniform(3.0, 10.0)
    rig.truth.transmission.compliance_slope[site.rows] = slope / 30 if site.actuator == "roll" else slope


@known
def cable_drag_axis(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A cable pulls an axis back, with hysteresis over a long stroke; `x` is its force one millimetre away."""
    force, stroke = site.scaled(x, "force"), site.scaled(1e-3, "length")
    m = rig.truth.motor
    m.cable[site.rows], m.cable_loop[site.rows] = force / stroke, 0.6 * force
    m.cable_rest[site.rows] = site.rng.uniform(-0.5, 0.5) * stroke
    m.cable_reach[site.rows] = 0.4 * stroke
    return {"stiffness": force / stroke, "force": 0.6 * force}
