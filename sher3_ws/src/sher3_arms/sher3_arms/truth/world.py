"""An arm in MuJoCo: it follows a motion under the control of its nominal model, and is recorded like a real one."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from types import ModuleType
from typing import Any

import numpy as np

from sher3_arms.errors import ArmsError, Unstable
from sher3_arms.truth.faults import BEHIND, Fault, passive

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
GIVING = "giving"
"""Name of the joint behind a motor's."""
FINE = 0.00025
"""Time step where a motor has a joint of its own, s: its rotor is light."""
STOPS = (0.001, 1.0)
"""Time constant, s, and damping of a stop."""
LOSS = 0.002
"""Damping over stiffness of a spring behind a motor, s."""
CROSSED, RARE = 0.5, 0.01
"""Share of a gap between the places behind which a load is, on either side, for that share of the record: less is a
load that rests on one stop."""
DUST = 1e-5
"""Inertia of a payload about its own centre, kg m^2: it is small and heavy."""
ASTRAY = 0.5
"""Tracking error, rad, beyond which an arm no longer follows: a drive would have stopped it."""
NOISE = 0.002
"""Standard deviation of a recorded torque over the joint's rms torque: the resolution of a drive's current."""


@dataclass(frozen=True)
class Record:
    """What is recorded: (n,) time, (n, k) positions of the motors and of the links, rad, and efforts, N m."""

    names: tuple[str, ...]
    time: np.ndarray
    position: np.ndarray
    effort: np.ndarray
    noise: np.ndarray
    link: np.ndarray


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
    for part in fault.parts if fault is not None else ():
        if part.kind in BEHIND:
            _second_joint(api, spec, part)
    model = spec.compile()
    for j in range(model.njnt):  # the motion stays within the limits, and a stop is no fault of this list
        model.jnt_limited[j] = model.joint(j).name == GIVING and model.jnt_limited[j]
    for part in fault.parts if fault is not None else ():
        _set(model, part)
    return model


def _set(model: Any, fault: Fault) -> None:
    """Set a fault where MuJoCo has a field for it."""
    if fault.joint < 0:
        return
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
    elif fault.kind == "elastic":
        behind = model.joint(GIVING).id
        model.jnt_stiffness[behind] = fault.other["stiffness"]
        model.dof_damping[model.jnt_dofadr[behind]] = LOSS * fault.other["stiffness"]


def _second_joint(api: ModuleType, spec: Any, fault: Fault) -> None:
    """Put a joint behind the motor's, on the same body and axis: a gap between stops, or a spring with some damping."""
    motor = spec.joints[fault.joint]
    motor.armature = fault.other["rotor"]
    behind = motor.parent.add_joint(name=GIVING, type=motor.type, axis=motor.axis, pos=motor.pos)
    if fault.kind == "backlash":
        behind.range, behind.limited = [-0.5 * fault.size, 0.5 * fault.size], api.mjtLimited.mjLIMITED_TRUE
        behind.solref_limit = list(STOPS)


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
    """Simulate an arm with a fault along a motion and return what its encoders and drives tell.

    Raises:
        Unstable: the arm does not follow the motion.
    """
    api = engine()
    nominal, real = load(urdf), load(urdf, fault)
    step = FINE if any(part.kind in BEHIND for part in fault.parts) else STEP
    real.opt.timestep = step
    time, q, v, a = motion(nominal, seconds, rng)
    ahead = inverse(nominal, q, v, a)
    data, model = api.MjData(real), api.MjData(nominal)
    names = tuple(nominal.joint(i).name for i in range(nominal.njnt))
    at_motor = np.array([int(real.jnt_dofadr[real.joint(name).id]) for name in names])
    data.qpos[at_motor], data.qvel[at_motor] = q[0], v[0]
    gain = np.ones(nominal.nv)
    for part in fault.parts:
        if part.kind == "gain":
            gain[part.joint] += part.size
    given = _late(fault, step)
    position, link, effort = np.empty_like(q), np.empty_like(q), np.empty_like(q)
    fine = round(PERIOD / step)
    for k in range(len(time)):
        position[k] = data.qpos[at_motor]
        if not (np.abs(position[k] - q[k]) < ASTRAY).all():
            raise Unstable
        link[k] = _link_positions(real, data, fault, position[k])
        after = min(k + 1, len(time) - 1)
        for part_of in range(fine):
            share = part_of / fine
            at, speed, need = ((1.0 - share) * x[k] + share * x[after] for x in (q, v, ahead))
            motor, rate = data.qpos[at_motor], data.qvel[at_motor]
            model.qpos[:] = motor
            api.mj_fwdPosition(nominal, model)
            pull = np.zeros(nominal.nv)
            api.mj_mulM(nominal, model, pull, STIFF**2 * (at - motor) + 2.0 * DAMPED * STIFF * (speed - rate))
            force = need + pull
            if part_of == 0:
                effort[k] = force
            drive = gain * given(force)
            extra = sum((passive(part, data.qpos[at_motor], data.qvel[at_motor], drive) for part in fault.parts), drive)
            data.qfrc_applied[at_motor] = extra
            api.mj_step(real, data)
    effort = _recorded_late(effort, fault, time)
    noise = NOISE * np.sqrt(np.mean(effort**2, axis=0))
    effort = effort + noise * rng.standard_normal(effort.shape)
    return Record(names, time, COUNT * np.round(position / COUNT), effort, noise, COUNT * np.round(link / COUNT))


def shows(fault: Fault, found: Record) -> bool:
    """Return whether a fault shows in a record: a gap does where its load is seen at both stops."""
    gaps = [part for part in fault.parts if part.kind == "backlash"]
    apart = np.quantile(found.link - found.position, (RARE, 1.0 - RARE), axis=0)
    return all(np.ptp(apart[:, part.joint]) > CROSSED * part.size for part in gaps)


def _link_positions(real: Any, data: Any, fault: Fault, position: np.ndarray) -> np.ndarray:
    """Return the positions of the links (k,): those of the motors, and what a joint behind one gives."""
    out = position.copy()
    if fault.kind in BEHIND:
        out[fault.joint] += data.qpos[int(real.jnt_qposadr[real.joint(GIVING).id])]
    return out


def _late(fault: Fault, step: float) -> Callable[[np.ndarray], np.ndarray]:
    """Return what turns the force that is asked for at each step into the one that acts, (k,): late on one joint."""
    if fault.kind != "late_drive":
        return lambda force: force
    waiting: deque[float] = deque(maxlen=max(1, round(fault.size / step)) + 1)

    def given(force: np.ndarray) -> np.ndarray:
        waiting.append(float(force[fault.joint]))
        out = force.copy()
        out[fault.joint] = waiting[0]
        return out

    return given


def _recorded_late(effort: np.ndarray, fault: Fault, time: np.ndarray) -> np.ndarray:
    """Return the efforts (n, k) as recorded: late on one joint."""
    if fault.kind == "late_effort":
        effort = effort.copy()
        effort[:, fault.joint] = np.interp(time - fault.size, time, effort[:, fault.joint])
    return effort


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
