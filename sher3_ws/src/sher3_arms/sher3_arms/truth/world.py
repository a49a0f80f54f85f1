"""An arm in MuJoCo: it follows a motion under the control of its nominal model, and is recorded like a real one."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from types import ModuleType
from typing import Any

import numpy as np

from sher3_arms.errors import ArmsError
from sher3_arms.truth.faults import Fault, passive

STEP = 0.001
"""Time step, s."""
PERIOD = 0.004
"""Of the control and of the record, s."""
WAVES = ((0.06, 0.45), (0.13, 0.3), (0.29, 0.15))
"""Frequency, Hz, and share of the reach of each wave of the motion."""
REACH = 1.0
"""Largest reach from the middle of a joint's range, rad."""
SHARE = 0.6
"""Share of the range that the motion takes at most."""
STIFF, DAMPED = 40.0, 0.9
"""Natural frequency, rad/s, and damping of the tracking loop."""
COUNT = 2.0 * np.pi / 2**22
"""One count of the encoders, rad: 16 bits on the motor, behind a reduction of 64."""
DUST = 1e-5
"""Inertia of a payload about its own centre, kg m^2: it is small and heavy."""
NOISE = 0.002
"""Standard deviation of a recorded torque over the joint's rms torque: the resolution of a drive's current."""


@dataclass(frozen=True)
class Record:
    """What is recorded: (n,) time, (n, k) positions, rad, and efforts, N m."""

    names: tuple[str, ...]
    time: np.ndarray
    position: np.ndarray
    effort: np.ndarray
    noise: np.ndarray


def engine() -> ModuleType:
    """Return MuJoCo; raises ArmsError where it is not installed."""
    try:
        return import_module("mujoco")
    except ImportError as error:
        raise ArmsError("MuJoCo is not installed", remedy="install the extra `mujoco` of this project") from error


def load(urdf: str, fault: Fault | None = None) -> Any:
    """Compile an arm; a fault that MuJoCo has fields for is set there."""
    api = engine()
    spec = api.MjSpec.from_string(urdf)
    spec.option.timestep = STEP
    spec.option.integrator = api.mjtIntegrator.mjINT_IMPLICITFAST
    if fault is not None and fault.kind == "payload":
        names = [j.name for j in spec.joints]
        carrier = next(b for b in spec.bodies if names[-1] in [j.name for j in b.joints])
        place = [fault.other[x] for x in "xyz"]
        body = carrier.add_body(name="carried", pos=place)
        body.mass, body.inertia, body.explicitinertial = fault.size * mass_behind(spec), [DUST] * 3, True
        body.ipos, body.iquat = [0.0] * 3, [1.0, 0.0, 0.0, 0.0]
    model = spec.compile()
    model.jnt_limited[:] = 0  # the motion stays within the limits, and a stop is no fault of this list
    if fault is not None and fault.joint >= 0:
        row = int(model.jnt_dofadr[fault.joint])
        if fault.kind == "coulomb":
            model.dof_frictionloss[row] = fault.size
        elif fault.kind == "viscous":
            model.dof_damping[row] = fault.size
        elif fault.kind == "armature":
            model.dof_armature[row] = fault.size
        elif fault.kind == "spring":
            model.jnt_stiffness[fault.joint] = fault.size
            model.qpos_spring[model.jnt_qposadr[fault.joint]] = fault.other["reference"]
    return model


def mass_behind(spec: Any) -> float:
    """Return the mass of the whole arm, kg: payloads are a share of it."""
    return float(sum(body.mass for body in spec.bodies))


def motion(model: Any, seconds: float, rng: np.random.Generator) -> tuple[np.ndarray, ...]:
    """Return position, velocity and acceleration (n, k) of a motion of all joints at once."""
    time = np.arange(0.0, seconds, PERIOD)
    low, high = np.array(model.jnt_range).T
    free = low == high  # a joint without limits
    low, high = np.where(free, -np.pi, low), np.where(free, np.pi, high)
    middle, reach = (low + high) / 2.0, np.minimum(SHARE * (high - low) / 2.0, REACH)
    q, v, a = (np.zeros((len(time), model.nv)) for _ in range(3))
    for j in range(model.nv):
        q[:, j] = middle[j]
        for frequency, share in WAVES:
            w = 2.0 * np.pi * frequency * rng.uniform(0.8, 1.2)
            phase, size = rng.uniform(0.0, 2.0 * np.pi), share * reach[j]
            q[:, j] += size * np.sin(w * time + phase)
            v[:, j] += size * w * np.cos(w * time + phase)
            a[:, j] -= size * w * w * np.sin(w * time + phase)
    return time, q, v, a


def inverse(model: Any, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
    """Return the torques (n, k) that a motion needs of the model."""
    api = engine()
    data, out = api.MjData(model), np.empty_like(q)
    for i in range(len(q)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[i], v[i], a[i]
        api.mj_inverse(model, data)
        out[i] = data.qfrc_inverse
    return out


def record(urdf: str, fault: Fault, seconds: float, rng: np.random.Generator) -> Record:
    """Simulate an arm with a fault along a motion and return what its encoders and drives tell."""
    api = engine()
    nominal, real = load(urdf), load(urdf, fault)
    time, q, v, a = motion(nominal, seconds, rng)
    ahead = inverse(nominal, q, v, a)
    data, model = api.MjData(real), api.MjData(nominal)
    data.qpos[:], data.qvel[:] = q[0], v[0]
    gain = np.ones(real.nv)
    if fault.kind == "gain":
        gain[fault.joint] += fault.size
    position, effort = np.empty_like(q), np.empty_like(q)
    fine = round(PERIOD / STEP)
    for k in range(len(time)):
        position[k] = data.qpos
        after = min(k + 1, len(time) - 1)
        for part in range(fine):
            share = part / fine
            at, speed, need = ((1.0 - share) * x[k] + share * x[after] for x in (q, v, ahead))
            model.qpos[:] = data.qpos
            api.mj_fwdPosition(nominal, model)
            pull = np.zeros(real.nv)
            api.mj_mulM(nominal, model, pull, STIFF**2 * (at - data.qpos) + 2.0 * DAMPED * STIFF * (speed - data.qvel))
            force = need + pull
            if part == 0:
                effort[k] = force
            data.qfrc_applied[:] = gain * force + passive(fault, data.qpos, data.qvel, gain * force)
            api.mj_step(real, data)
    noise = NOISE * np.sqrt(np.mean(effort**2, axis=0))
    names = tuple(api.mj_id2name(real, api.mjtObj.mjOBJ_JOINT, i) for i in range(real.njnt))
    effort = effort + noise * rng.standard_normal(effort.shape)
    return Record(names, time, COUNT * np.round(position / COUNT), effort, noise)


def inertias(model: Any, q: np.ndarray) -> np.ndarray:
    """Return the inertia that each joint moves in a posture, (k,) kg m^2."""
    api = engine()
    data = api.MjData(model)
    data.qpos[:] = q
    api.mj_forward(model, data)
    out = np.empty(model.nv)
    for j in range(model.nv):
        column = np.zeros(model.nv)
        column[j] = 1.0
        result = np.zeros(model.nv)
        api.mj_mulM(model, data, result, column)
        out[j] = result[j]
    return out
