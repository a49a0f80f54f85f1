"""The drives of an MJCF model: whether a control is a force or a place, and what a simulated step adds to a force.

An actuator gives gain * control + bias (chapter Computation of MuJoCo's documentation).
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_machines.intake.columns import acting

from sher3_chain.manipulator.mjcf.bodies import SLIDE
from sher3_chain.manipulator.mjcf.gears import coupled
from sher3_chain.manipulator.mjcf.passive import AFFINE, FIXED, NONE, at_joint, is_passive

EULER, RUNGE_KUTTA, IMPLICIT, IMPLICIT_FAST = range(4)
"""MuJoCo's numbers of integrators (mjtIntegrator)."""
EULER_DAMP = 1 << 15
"""Flag that switches the implicit damping of Euler's method off (mjDSBL_EULERDAMP)."""
CLAMP_OFF = 1 << 7
"""Flag that lets controls go beyond their range (mjDSBL_CLAMPCTRL)."""

NO_DELAY: Mapping[int, float] = defaultdict(float)
"""Delay of each actuator, s, in versions of MuJoCo before 3.4 that have none."""
SLOWER = 1.5
"""Steps in a row from which a log is slower than its simulator."""
TENDON, WRAPPED_JOINT = 3, 1
"""MuJoCo's numbers of a transmission by a tendon (mjtTrn), and of a joint in a tendon (mjtWrap)."""


@dataclass(frozen=True)
class Drive:
    """An actuator on one joint.

    Attributes:
        name: of the actuator.
        number: of its control.
        gear: joint force per force of the actuator.
        servo: whether its control is a place, else a force.
        factor: what turns the control into a place, m or rad, or into the joint's force, N or N m.
        position_gain, velocity_gain: of a servo, N/m and N/(m/s), or N m/rad and N m/(rad/s), at the joint.
        limit: largest force at the joint; None: none stated.
        delay: of its control, s.
        within: smallest and largest control that acts, in its own unit; None: none stated.
    """

    name: str
    number: int
    gear: float
    servo: bool
    factor: float
    position_gain: float = 0.0
    velocity_gain: float = 0.0
    limit: float | None = None
    delay: float = 0.0
    within: tuple[float, float] | None = None

    def target(self, control: Array) -> Array:
        """Return what a control (n,) asks for: a place, m or rad, or a force, N or N m; NaN where it is infinite."""
        return self.factor * acting(control, self.within)

    def law(self, asked: Array, q: Array, v: Array) -> Array:
        """Return the joint's force (n,), N or N m, of what was asked, at a place and a speed; without its limit."""
        return self.position_gain * (asked - q) - self.velocity_gain * v if self.servo else asked


class Step(NamedTuple):
    """By what a force differs from the one that acted between two steps of a simulator.

    It is larger by `inertia` times acceleration, kg or kg m^2, and by `damping` times speed, N/(m/s) or N m/(rad/s),
    and acts `late` s after its stamp, as a control does that holds over a whole step.
    """

    inertia: float = 0.0
    damping: float = 0.0
    late: float = 0.0


def steps_in(period: float, loop: float | None) -> float:
    """Return the steps of a loop in a row of a log, s each; 1 where the log is no slower, or there is no loop."""
    return period / loop if loop is not None and period > SLOWER * loop else 1.0


@dataclass(frozen=True)
class Driven:
    """How the model drives one joint.

    Attributes:
        slides: whether the joint slides.
        recorded, of_law: what a step adds to the force that the simulator recorded, and to that of the drive's law by
            the speed of central differences.
        damping: of the joint in the model, N/(m/s) or N m/(rad/s).
        loop: time step of the model, s; None: of no simulator.
        drive: its actuator; None: none, or none whose force is a line in control, place and speed.
        reason: why there is no drive.
    """

    slides: bool
    recorded: Step
    of_law: Step
    damping: float
    loop: float | None
    drive: Drive | None
    reason: str = ""


def driven(source: Any) -> dict[str, Driven]:
    """Return joint -> how an `MjModel` drives it, of every joint that turns or slides."""
    return {_name(source.joint(j).name, j): _driven(source, j) for j in range(source.njnt) if source.jnt_type[j] > 1}


def _name(name: str, joint: int) -> str:
    return name or f"joint{joint}"


def _driven(source: Any, joint: int) -> Driven:
    """Reckon what a step adds: its speed lies half a step before central differences, an implicit one behind.

    The method of Runge and Kutta follows place and speed within a step and holds the control, so what was recorded at
    its beginning is half a step early, and all but the control was not (`_followed`).
    """
    half, method = 0.5 * float(source.opt.timestep), source.opt.integrator
    damping = float(source.dof_damping[source.jnt_dofadr[joint]])
    drive, reason = _drive(source, joint)
    stiffness, gain = _held(source, joint)
    recorded = of_law = Step()
    if method in (IMPLICIT, IMPLICIT_FAST):
        recorded, of_law = Step(half * (damping + 2.0 * gain)), Step(half * (damping + gain))
    elif method == RUNGE_KUTTA:
        mass = float(source.dof_M0[source.jnt_dofadr[joint]])
        recorded, of_law = _followed(mass, damping, stiffness, gain, 2.0 * half), Step(late=half)
    elif method == EULER:
        own = half * damping * (-1.0 if source.opt.disableflags & EULER_DAMP else 1.0)
        recorded, of_law = Step(own), Step(own - half * gain)
    return Driven(source.jnt_type[joint] == SLIDE, recorded, of_law, damping, 2.0 * half, drive, reason)


def _followed(mass: float, damping: float, stiffness: float, gain: float, step: float) -> Step:
    """Return by what the force of a servo at the beginning of a step of Runge and Kutta differs from its mean.

    The joint by itself is a linear system, which the method takes from step to step by the first terms of its
    exponential; each step has a control of its own, chosen so that the places of all steps lie on a line, or on a
    parabola. Speeds at their beginning, which repeat from step to step, and the force there then follow.
    """
    if not stiffness:
        return Step(0.5 * step * gain, 0.0, 0.5 * step)
    rates = step * np.array([[0.0, 1.0], [-stiffness / mass, -(gain + damping) / mass]])
    terms = [np.linalg.matrix_power(rates, n) / math.factorial(n) for n in range(5)]
    (qq, qv), (vq, vv) = np.sum(terms, axis=0)
    by_control = (1.0 - qq, -vq)  # what is at rest where it was told to be stays there
    pull = by_control[1] / by_control[0]
    keeps = 1.0 - (vv - pull * qv)

    def force(place: float, speed: float) -> float:
        """At place zero, with a speed, where the next place is known."""
        return stiffness * (place - qv * speed) / by_control[0] - gain * speed

    on_line = force(step, pull * step / keeps)
    grows = pull * step**2 / keeps
    on_parabola = force(0.5 * step**2, (0.5 * pull * step**2 - grows) / keeps)
    more = on_line - damping
    return Step(on_parabola - mass - 0.5 * step * on_line, more, 0.5 * step)


def _held(source: Any, joint: int) -> tuple[float, float]:
    """Return the force per place and per speed of all actuators on a joint that a control reaches, at the joint."""
    holding = [
        i for i in at_joint(source, joint) if source.actuator_biastype[i] == AFFINE and not is_passive(source, i)
    ]
    each = [-source.actuator_biasprm[i][1:3] * source.actuator_gear[i][0] ** 2 for i in holding]
    stiffness, gain = np.sum(each, axis=0) if each else (0.0, 0.0)
    return float(stiffness), float(gain)


def _drive(source: Any, joint: int) -> tuple[Drive | None, str]:
    """Return the actuator of a joint, or why its force is not known from its control."""
    if through := by_tendon(source, joint):
        return None, f"actuator {through} moves it by a tendon"
    if coupled(source, joint):
        return None, "an equality couples it with another joint"
    driving = [i for i in at_joint(source, joint) if not is_passive(source, i)]
    if not driving:
        return None, "the model has no actuator on it"
    if len(driving) > 1:
        return None, f"the model has {len(driving)} actuators on it"
    i = driving[0]
    name, gear = source.actuator(i).name or f"actuator{i}", float(source.actuator_gear[i][0])
    control = int(getattr(source, "actuator_ctrladr", range(source.nu))[i])
    if source.actuator_dyntype[i] != NONE:
        return None, f"actuator {name} has dynamics of its own"
    if source.actuator_gaintype[i] != FIXED or source.actuator_biastype[i] not in (NONE, AFFINE) or not gear:
        return None, f"the force of actuator {name} is no line in control, place and speed"
    within = None
    if source.actuator_ctrllimited[i] and not source.opt.disableflags & CLAMP_OFF:
        within = (float(source.actuator_ctrlrange[i][0]), float(source.actuator_ctrlrange[i][1]))
    gain = float(source.actuator_gainprm[i][0])
    offset, place, speed = (float(x) for x in source.actuator_biasprm[i][:3])
    limit, delay = _limit(source, i, joint, gear), float(getattr(source, "actuator_delay", NO_DELAY)[i])
    if source.actuator_biastype[i] == NONE or (not place and not speed and not offset):
        return Drive(name, control, gear, False, gain * gear, limit=limit, delay=delay, within=within), ""
    if not place or not gain or offset:
        return (
            None,
            f"actuator {name} is no servo of places: its force is {gain:g} u {offset:+g} {place:+g} q {speed:+g} v",
        )
    gains = -gain / (place * gear), -place * gear**2, -speed * gear**2
    return Drive(name, control, gear, True, *gains, limit, delay, within), ""


def by_tendon(source: Any, joint: int) -> str:
    """Return the name of an actuator that pulls at a joint by a fixed tendon; empty where none does."""
    for i in range(getattr(source, "nactuator", source.nu)):
        if source.actuator_trntype[i] == TENDON:
            tendon = source.actuator_trnid[i][0]
            first, count = source.tendon_adr[tendon], source.tendon_num[tendon]
            ends = source.wrap_objid[first : first + count][source.wrap_type[first : first + count] == WRAPPED_JOINT]
            if joint in ends:
                return source.actuator(i).name or f"actuator{i}"
    return ""


def _limit(source: Any, actuator: int, joint: int, gear: float) -> float | None:
    """Return the largest force that an actuator may give at its joint; None where none is stated."""
    limits = []
    if source.actuator_forcelimited[actuator]:
        limits.append(abs(gear) * float(np.abs(source.actuator_forcerange[actuator]).max()))
    if source.jnt_actfrclimited[joint]:
        limits.append(float(np.abs(source.jnt_actfrcrange[joint]).max()))
    return min(limits) if limits and min(limits) > 0.0 else None
