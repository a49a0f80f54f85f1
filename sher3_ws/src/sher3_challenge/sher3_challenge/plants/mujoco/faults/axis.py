"""Faults of an axis: host, transport, drive and encoders; bodies, springs, tendons and friction on it."""

from __future__ import annotations

import math
import operator
from dataclasses import replace

from sher3_challenge.plants.declared import DELTAS
from sher3_challenge.plants.kinds import Catalogue, scaled_by, set_to
from sher3_challenge.plants.mujoco.axes.laws import Film, Grease, Guide, Poles
from sher3_challenge.plants.mujoco.axes.parts import ELEMENTS, Axis, Bristle, Drive
from sher3_challenge.plants.mujoco.axes.wheels import Eccentric
from sher3_challenge.plants.mujoco.rig import Rig
from sher3_challenge.plants.site import Site

CATALOGUE = Catalogue()
known = CATALOGUE.known

CATALOGUE.changes(
    operator.add,
    command_delay="host.delay",
    axis_skew="host.delay",
    encoder_scale="host.encoder_scale",
    encoder_offset="host.offset",
    lead_error="axes.lead_error",
    coulomb_friction="axes.coulomb",  # MuJoCo's dry friction on the motor's joint
    viscous_friction="axes.viscous",
    backlash="axes.gap",  # between whose sides the load's guide is pushed, against MuJoCo's own soft contact
)
CATALOGUE.changes(scaled_by, controller_gain="host.gain", torque_constant="axes.torque_gain")
CATALOGUE.changes(set_to, command_jitter="host.jitter", dropped_commands="host.loss", velocity_deadband="axes.deadband")


def bristles(force: float, reach: float) -> tuple[Bristle, ...]:
    """Return the two bristles of a friction that builds up over `reach`."""
    return tuple(Bristle(share * force, part * reach) for share, part in ELEMENTS)


def phase(site: Site) -> float:
    """Return a phase between 0 and 2 pi."""
    return float(site.rng.uniform(0, 2 * math.pi))


def axis_of(rig: Rig, site: Site) -> Axis:
    """Return the axis on which the fault sits."""
    return rig.axes[site.index]


@known
def stribeck_friction(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Dry friction less what the film carries, which falls with the square of speed and not as a Gaussian."""
    static, level = site.scaled(x, "force"), float(site.rng.uniform(0.1, 0.4))
    velocity = site.scaled(float(site.rng.uniform(4e-4, 1.6e-3)), "speed")
    axis = axis_of(rig, site)
    axis.coulomb += level * static
    # where a Gaussian has fallen to 1/e, the film's law has too
    axis.levels += (Film((1 - level) * static, velocity / math.sqrt(math.e - 1)),)
    return {"static": static, "force": level * static, "velocity": velocity}


@known
def presliding_friction(rig: Rig, site: Site, force: float) -> dict[str, float]:
    """Springs that drag light bodies over rough ground: straight flanks with two corners, no exponential."""
    reach = site.scaled(float(site.rng.uniform(25e-6, 110e-6)), "length")
    axis_of(rig, site).bristles += bristles(force, reach)
    return {"displacement": reach}


@known
def position_friction(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Friction along a wavy guide with crests narrower than its hollows."""
    force, period = site.scaled(x, "force"), site.scaled(float(site.rng.uniform(0.8e-3, 2.6e-3)), "length")
    guide = Guide(force, period, phase(site))
    axis_of(rig, site).levels += (guide,)
    return {"force": guide.mean, "amplitude": guide.mean, "period": period}


@known
def friction_drift(rig: Rig, site: Site, force: float, time_constant: float) -> None:
    """Grease that runs in at two rates."""
    axis_of(rig, site).levels += (Grease(force, time_constant),)


@known
def payload_mass(rig: Rig, site: Site, mass: float) -> None:
    """A body on the slider, which MuJoCo's gravity pulls down the vertical rails; or a mass on the platform."""
    axis = axis_of(rig, site)
    if site.actuator in DELTAS and site.rng.random() < 0.5:
        axis.mass += mass
        axis.gravity_gain += mass / rig.robot.delta.moving_mass
    else:
        axis.payload += mass


@known
def gravity_load(rig: Rig, site: Site, mass: float) -> None:
    """Weight without inertia, in the pattern of the axis's own."""
    carried = rig.robot.arm.tilt_mass if site.actuator == "tilt" else rig.robot.delta.moving_mass
    axis_of(rig, site).gravity_gain += mass / carried


@known
def cogging(rig: Rig, site: Site, amplitude: float, periods_per_rev: float) -> None:
    """Force of the motor's poles, with a third harmonic."""
    axis = axis_of(rig, site)
    axis.pushes += (Poles(amplitude, axis.lead / periods_per_rev, phase(site)),)


@known
def transmission_ripple(rig: Rig, site: Site, amplitude: float, periods_per_rev: float) -> None:
    """An eccentric wheel between motor and load."""
    axis = axis_of(rig, site)
    axis.ripples += (Eccentric(amplitude, axis.lead / periods_per_rev, phase(site)),)


@known
def transmission_hysteresis(rig: Rig, site: Site, width: float) -> dict[str, float]:
    """Friction in the nut winds the transmission up: the load stays back by what its bristles are bent."""
    half, reach = width / 2, site.scaled(float(site.rng.uniform(40e-6, 200e-6)), "length")
    axis = axis_of(rig, site)
    axis.windup, axis.windup_reach = half, reach
    return {"displacement": reach}


@known
def transmission_compliance(rig: Rig, site: Site, compliance: float, stiffness: float) -> None:
    """A spring between motor and load, which carries its share of the mass and swings on it."""
    axis = axis_of(rig, site)
    axis.compliance, axis.load_share = compliance, float(site.rng.uniform(0.1, 0.35))


@known
def cable_drag_axis(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A tendon pulls an axis back and drags bodies over rough ground; `x` is its pull one millimetre away."""
    force, stroke = site.scaled(x, "force"), site.scaled(1e-3, "length")
    axis = axis_of(rig, site)
    axis.spring += force / stroke
    axis.spring_rest = float(site.rng.uniform(-0.5, 0.5)) * stroke
    axis.bristles += bristles(0.6 * force, 0.3 * stroke)
    return {"stiffness": force / stroke, "force": 0.6 * force, "displacement": 0.3 * stroke}


@known
def drive_lag(rig: Rig, site: Site, time_constant: float) -> None:
    """The force follows through two poles that together delay slow changes by `time_constant`."""
    axis = axis_of(rig, site)
    axis.drive = replace(axis.drive or Drive(), lag=time_constant)


@known
def force_saturation(rig: Rig, site: Site, limit: float) -> None:
    """The force ends at a share of 12 N, of 0.3 N m on roll."""
    axis = axis_of(rig, site)
    axis.drive = replace(axis.drive or Drive(), limit=limit)


@known
def encoder_eccentricity(rig: Rig, site: Site, amplitude: float) -> None:
    """The encoder's disc turns off its centre; the load does not move."""
    rig.host.discs[site.index] = Eccentric(amplitude, axis_of(rig, site).lead, phase(site))
