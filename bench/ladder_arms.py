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
from sher3_diagnosis.filter import low_pass

sys.path.append(str(Path(__file__).parents[1] / "sher3_ws/src/sher3_chain/test"))
sys.path.append(str(Path(__file__).parents[1] / "tests"))
from drawn_arms import METHODS, NOISE, asked, drawn_xml, served
from meaning import meaningless

Array = NDArray[np.float64]
KINDS = {
    "viscous": "viscous_friction",
    "coulomb": "coulomb_friction",
    "spring": "spring_torque",
    "rotor": "rotor_inertia",
    "payload": "payload_mass",
}
"""What is drawn -> the effect that it is."""
SECONDS, BAND = 10.0, 20.0
"""Length of a motion, s, and cut-off of the fits, Hz."""
NOTICED = 0.05
"""Share of the signal from which a column of a fit is called a cause."""
CONTAINS = {"presliding_friction": "coulomb_friction", "stribeck_friction": "coulomb_friction"}
CONTAINS |= {"cable_torque": "spring_torque", "link_mass": "payload_mass", "link_inertia": "payload_mass"}
"""Effect -> what else is named with it: its law contains that."""


class Cause(NamedTuple):
    """What is wrong, at which joint, and its size as a share of what is drawn."""

    kind: str
    joint: int
    size: float


def drawn_causes(rng: np.random.Generator, joints: int) -> list[Cause]:
    """Return three to six causes, no two alike at one joint; a payload is at the last link."""
    places = [(k, j) for k in KINDS for j in range(joints) if k != "payload" or j == joints - 1]
    chosen = rng.choice(len(places), int(rng.integers(3, 7)), replace=False)
    return [Cause(*places[i], float(rng.uniform(0.4, 1.0))) for i in sorted(chosen)]


def with_causes(xml: str, causes: Sequence[Cause]) -> mujoco.MjModel:
    """Return the plant."""
    spec = mujoco.MjSpec.from_string(xml)
    for cause in causes:
        joint, size = spec.joints[cause.joint], cause.size * 0.5**cause.joint
        if cause.kind == "viscous":
            joint.damping[0] += 2.0 * size
        elif cause.kind == "coulomb":
            joint.frictionloss += size
        elif cause.kind == "spring":
            joint.stiffness[0] += 6.0 * size
        elif cause.kind == "rotor":
            joint.armature += 0.1 * size
        else:
            ball = {"type": mujoco.mjtGeom.mjGEOM_SPHERE, "size": [0.01, 0, 0], "pos": [0.25, 0, 0]}
            spec.bodies[-1].add_geom(**ball, mass=0.5 * cause.size, contype=0, conaffinity=0)
    return spec.compile()


def row_of_arm(seed: int) -> dict:
    """Return what is kept of one arm; each name has its joint, a payload none."""
    rng = np.random.default_rng([seed, 3])
    xml = drawn_xml(rng, servo=True, joints=int(rng.integers(2, 4)), methods=METHODS[:3])
    nominal = mujoco.MjModel.from_xml_string(xml)
    names = [nominal.joint(i).name for i in range(nominal.nv)]
    causes = drawn_causes(rng, nominal.nv)
    plant = with_causes(xml, causes)
    stamps = np.arange(round(SECONDS / plant.opt.timestep)) * plant.opt.timestep
    ctrl = asked(rng, stamps, plant.nu) * plant.actuator_gear[:, 0]
    qpos, force = served(plant, ctrl)
    qpos = qpos + NOISE * rng.standard_normal(qpos.shape)
    begun = time.perf_counter()
    verdict = gap.diagnose(xml, {"time": stamps, "ctrl": ctrl, "qpos": qpos, "actuator_force": force}).verdict
    told = [{at(x, c.actuator) for e in (c.effect, *c.rivals) for x in (e, CONTAINS.get(e, e))} for c in verdict.causes]
    seconds = time.perf_counter() - begun
    return {
        "seconds": seconds,
        "status": verdict.status,
        "truth": sorted(at(KINDS[c.kind], names[c.joint]) for c in causes),
        "powerless": [],
        "held": [],
        "impossible": meaningless(verdict),
        "sher3": [sorted(x) for x in told],
        "least squares": [[x] for x in fitted(nominal, names, qpos, force)],
    }


def at(effect: str, joint: str) -> str:
    """Return the name of an effect at a joint; a payload is carried by the last link, whoever names it."""
    return effect if effect == "payload_mass" else f"{effect} {joint}"


def fitted(nominal: mujoco.MjModel, names: Sequence[str], qpos: Array, force: Array) -> list[str]:
    """Return what least squares of all plain laws of each joint calls a cause."""
    data, period = mujoco.MjData(nominal), float(nominal.opt.timestep)
    q = low_pass(qpos, period, BAND)
    v = np.gradient(q, period, axis=0)
    a = np.gradient(v, period, axis=0)
    need = np.empty_like(q)
    for row in range(len(q)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[row], v[row], a[row]
        mujoco.mj_inverse(nominal, data)
        need[row] = data.qfrc_inverse
    left = low_pass(force * nominal.actuator_gear[:, 0] - need, period, BAND)
    inside = slice(len(q) // 20, -len(q) // 20)
    out = []
    for j, name in enumerate(names):
        soft = np.tanh(v[:, j] / (0.02 * np.abs(v[:, j]).max()))
        laws = {"rotor_inertia": a[:, j], "viscous_friction": v[:, j], "coulomb_friction": soft}
        laws |= {"spring_torque": q[:, j], "payload_mass": np.sin(q.sum(axis=1))}
        x = np.column_stack([*laws.values(), np.ones(len(q))])[inside]
        y = left[inside, j]
        beta = np.linalg.lstsq(x, y, rcond=None)[0]
        shares = np.abs(beta) * np.sqrt(np.mean(x**2, axis=0)) / np.sqrt(np.mean(force[:, j] ** 2))
        out += [at(law, name) for law, s in zip(laws, shares, strict=False) if s > NOTICED]
    return sorted(set(out))
