"""Arms of MuJoCo with three to six causes drawn at once, each at a joint of its own choice, for `drawn_machines.py`.

The arms, their losses, drives and integrators are those of `sher3_chain/test/drawn_arms.py`, whose file the diagnosis
is given. The plant has in addition what is drawn here, by MuJoCo's own means; least squares knows the healthy arm too
and fits the same laws of each joint to what its inverse dynamics leave.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import mujoco
import numpy as np
import sher3.gap as gap
from numpy.typing import NDArray
from sher3_arms.truth.world import inverse
from sher3_diagnosis.verdict import Verdict
from true_arm import Motion, motion_of, powerless_on

sys.path.append(str(Path(__file__).parents[1] / "sher3_ws/src/sher3_chain/test"))
sys.path.append(str(Path(__file__).parents[1] / "tests"))
from drawn_arms import METHODS, NOISE, asked, drawn_xml, served
from meaning import meaningless

Array = NDArray[np.float64]
EFFECTS = {
    "viscous": "viscous_friction",
    "coulomb": "coulomb_friction",
    "spring": "spring_torque",
    "rotor": "rotor_inertia",
    "payload": "payload_mass",
}
"""What is drawn -> the effect that it is."""
PARAMETERS = {"viscous": "extra", "coulomb": "force", "spring": "stiffness", "rotor": "inertia", "payload": "mass"}
"""What is drawn -> the parameter that says its size."""
LARGEST = {"viscous": 2.0, "coulomb": 1.0, "spring": 6.0, "rotor": 0.1, "payload": 0.5}
"""What is drawn -> its largest size at the first joint, SI units."""
SECONDS = 10.0
"""Length of a motion, s."""
UNIT = 0.1
"""Mass of a payload with which its column is reckoned, kg: it is linear."""
NOTICED = 0.05
"""Share of the signal from which a column of a fit is called a cause."""
OF_SERVOS = {"late": "command_delay", "weak": "controller_gain"}
"""What is drawn besides where the log has no forces -> the effect that it is."""
LATEST, WEAKEST = 12, 0.4
"""Largest delay of a servo, steps, and largest share that its law lacks."""
CONTAINS = {"presliding_friction": "coulomb_friction", "stribeck_friction": "coulomb_friction"}
CONTAINS |= {"cable_torque": "spring_torque", "link_mass": "payload_mass", "link_inertia": "payload_mass"}
"""Effect -> what else is named with it: its law contains that."""


class Cause(NamedTuple):
    """What is wrong, at which joint, and its size as a share of what is drawn."""

    kind: str
    joint: int
    size: float


def drawn_causes(rng: np.random.Generator, joints: int, kinds: Sequence[str] = tuple(EFFECTS)) -> list[Cause]:
    """Return three to six causes, no two alike at one joint; a payload is at the last link."""
    places = [(k, j) for k in kinds for j in range(joints) if k != "payload" or j == joints - 1]
    chosen = rng.choice(len(places), int(rng.integers(3, 7)), replace=False)
    return [Cause(*places[i], float(rng.uniform(0.4, 1.0))) for i in sorted(chosen)]


def amount(cause: Cause) -> float:
    """Return the size of a cause, SI units, those of the joints fall as their links do; of a servo steps or a share."""
    if cause.kind in OF_SERVOS:
        return float(round(LATEST * cause.size)) if cause.kind == "late" else -WEAKEST * cause.size
    return LARGEST[cause.kind] * cause.size * (1.0 if cause.kind == "payload" else 0.5**cause.joint)


def with_causes(xml: str, causes: Sequence[Cause]) -> mujoco.MjModel:
    """Return the plant."""
    spec = mujoco.MjSpec.from_string(xml)
    for cause in causes:
        joint, size = spec.joints[cause.joint], amount(cause)
        if cause.kind == "viscous":
            joint.damping[0] += size
        elif cause.kind == "coulomb":
            joint.frictionloss += size
        elif cause.kind == "spring":
            joint.stiffness[0] += size
        elif cause.kind == "rotor":
            joint.armature += size
        elif cause.kind == "late":
            drive = spec.actuators[cause.joint]
            drive.delay, drive.nsample = size * spec.option.timestep, LATEST + 2
        elif cause.kind == "weak":
            drive = spec.actuators[cause.joint]
            drive.gainprm[0] *= 1.0 + size
            drive.biasprm[1:3] *= 1.0 + size
        else:
            ball = {"type": mujoco.mjtGeom.mjGEOM_SPHERE, "size": [0.01, 0, 0], "mass": size}
            own = spec.bodies[-1].add_body(pos=[0.25, 0, 0])  # what holds the link up does not hold its payload
            own.add_geom(**ball, contype=0, conaffinity=0)
    return spec.compile()


def row_of_arm(seed: int, forces: bool = True) -> dict:
    """Return what is kept of one arm; each name has its joint, a payload none.

    Without `forces` in its log the law of its servos stands for them, and servos may be late or weak.
    """
    rng = np.random.default_rng([seed, 3] if forces else [seed, 4])
    xml = drawn_xml(rng, servo=True, joints=int(rng.integers(2, 4)), methods=METHODS[:3])
    nominal = mujoco.MjModel.from_xml_string(xml)
    names = [nominal.joint(i).name for i in range(nominal.nv)]
    causes = drawn_causes(rng, nominal.nv, [*EFFECTS, *(() if forces else OF_SERVOS)])
    plant = with_causes(xml, causes)
    stamps = np.arange(round(SECONDS / plant.opt.timestep)) * plant.opt.timestep
    ctrl = asked(rng, stamps, plant.nu) * plant.actuator_gear[:, 0]
    qpos, force = served(plant, ctrl)
    qpos = qpos + NOISE * rng.standard_normal(qpos.shape)
    begun = time.perf_counter()
    log = {"time": stamps, "ctrl": ctrl, "qpos": qpos, **({"actuator_force": force} if forces else {})}
    verdict = gap.diagnose(xml, log).verdict
    told = [{at(x, c.actuator) for e in (c.effect, *c.rivals) for x in (e, CONTAINS.get(e, e))} for c in verdict.causes]
    seconds = time.perf_counter() - begun
    motion = motion_of(nominal, qpos, force)
    called = [at((EFFECTS | OF_SERVOS)[c.kind], names[c.joint]) for c in causes]
    loaded = with_causes(xml, [Cause("payload", nominal.nv - 1, UNIT / LARGEST["payload"])])
    carried = (inverse(loaded, *motion[:3]) - inverse(nominal, *motion[:3])) / UNIT
    bodily = [(c.kind, c.joint) for c in causes if c.kind in EFFECTS]
    return {
        "seconds": seconds,
        "status": verdict.status,
        "truth": sorted(called),
        "powerless": sorted(powerless_on(motion, carried, bodily, [at(EFFECTS[k], names[j]) for k, j in bodily])),
        "held": held(causes, names, verdict),
        "impossible": meaningless(verdict),
        "sher3": [sorted(x) for x in told],
        "least squares": [[x] for x in fitted(motion, force, names)],
    }


def held(causes: Sequence[Cause], names: Sequence[str], verdict: Verdict) -> list[bool]:
    """Return whether each interval of a size that was drawn holds it."""
    drawn = {at(EFFECTS[c.kind], names[c.joint]): (PARAMETERS[c.kind], amount(c)) for c in causes if c.kind in EFFECTS}
    out = []
    for cause in verdict.causes:
        name, value = drawn.get(at(cause.effect, cause.actuator), ("", 0.0))
        p = cause.parameters.get(name)
        if p is not None and p.low is not None and p.high is not None:
            out.append(p.low <= value <= p.high)
    return out


def at(effect: str, joint: str) -> str:
    """Return the name of an effect at a joint; a payload is carried by the last link, whoever names it."""
    return effect if effect == "payload_mass" else f"{effect} {joint}"


def fitted(m: Motion, force: Array, names: Sequence[str]) -> list[str]:
    """Return what least squares of all plain laws of each joint calls a cause."""
    inside = slice(len(m.q) // 20, -len(m.q) // 20)
    out = []
    for j, name in enumerate(names):
        soft = np.tanh(m.v[:, j] / (0.02 * np.abs(m.v[:, j]).max()))
        laws = {"rotor_inertia": m.a[:, j], "viscous_friction": m.v[:, j], "coulomb_friction": soft}
        laws |= {"spring_torque": m.q[:, j], "payload_mass": np.sin(m.q.sum(axis=1))}
        x = np.column_stack([*laws.values(), np.ones(len(m.q))])[inside]
        beta = np.linalg.lstsq(x, m.left[inside, j], rcond=None)[0]
        shares = np.abs(beta) * np.sqrt(np.mean(x**2, axis=0)) / np.sqrt(np.mean(force[:, j] ** 2))
        out += [at(law, name) for law, s in zip(laws, shares, strict=False) if s > NOTICED]
    return sorted(set(out))
