"""mujoco.sysid on the axes and servos of `drawn_machines.py`: needs the extra `sysid`.

It is given what a user would give it: a MuJoCo model of one joint with the stated mass, and mass, damping, dry
friction, constant force and spring (of a turning axis the weight at an arm) to fit. An axis is driven by its recorded
effort; an open chain drifts, so it is rolled out over stretches that each begin at the recorded state. A servo follows
its recorded reference in one piece. Delays and friction that falls with speed are not among the numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import redirect_stdout
from io import StringIO
from typing import NamedTuple

import mujoco
import numpy as np
from mujoco import sysid
from numpy.typing import NDArray
from sher3_chain.readings.signals import AxisSignals, signals_of

Array = NDArray[np.float64]
STRETCH, STRETCHES, LONGEST = 0.5, 20, 20.0
"""Length of a stretch of an axis, s, and how many of them, evenly spread, are fitted; length of a servo's record, s."""
FINEST = 0.002
"""Longest time step, s."""
ARM = 0.03
"""Share of a turning axis' inertia whose point hangs on it, squared: its weight is set by gravity."""
ITERATIONS = 30


class Number(NamedTuple):
    """What is fitted: where it starts, its bounds, and what sets it in a model."""

    start: float
    low: float
    high: float
    put: Callable[[mujoco.MjSpec, float], None]


def fitted(drawn) -> Array:
    """Return what the fit says of a drawn machine (`Drawn`), in the order of the columns of `drawn_machines.py`.

    That is mass beyond the stated one, viscous and dry friction, constant force, and spring, or weight at an arm and 0.
    """
    axis = drawn.machine.described.axes[0]
    run = signals_of(drawn.run, axis, "run")
    servo, turns = axis.servo, axis.motion == "rotary"
    effort = run.reference if servo else run.effort
    mass = 1e-3 if servo else float(axis.mass)
    spec = model_of(mass, turns, servo, float(drawn.run.period))
    numbers = numbers_of(mass, turns, servo, run, float(np.std(effort)), axis.gravity.arm)
    found = optimised(spec, numbers, run, np.asarray(effort)[:, 0])
    own = found["mass"] - (0.0 if servo else mass)
    rest = [found["viscous"], found["dry"], found["constant"]]
    return np.array([own, *rest, *([found["arm"] - axis.gravity.arm, 0.0] if turns else [found["spring"]])])


def model_of(mass: float, turns: bool, servo: bool, period: float) -> mujoco.MjSpec:
    """Return one joint with its mass as armature, a drive, and a bias for a constant force."""
    step = period / np.ceil(period / FINEST)
    kind, axis = ("hinge", "0 1 0") if turns else ("slide", "1 0 0")
    drive = '<position name="drive" joint="axis" kp="1"/>' if servo else '<motor name="drive" joint="axis"/>'
    bias = '<general name="bias" joint="axis" gainprm="0" biastype="affine" biasprm="0"/>'
    dust = f"{1e-6 * mass} {1e-6 * mass} {1e-6 * mass}"
    text = f"""<mujoco><option timestep="{step}" integrator="implicitfast" gravity="0 0 0"/><worldbody><body>
    <joint name="axis" type="{kind}" axis="{axis}" armature="{mass}"/>
    <inertial pos="0 0 {-ARM}" mass="{mass}" diaginertia="{dust}"/></body></worldbody>
    <actuator>{drive}{bias}</actuator></mujoco>"""
    spec = mujoco.MjSpec.from_string(text)
    joint = {"objtype": mujoco.mjtObj.mjOBJ_JOINT, "objname": "axis"}
    spec.add_sensor(name="axis_pos", type=mujoco.mjtSensor.mjSENS_JOINTPOS, **joint)
    return spec


def numbers_of(
    mass: float, turns: bool, servo: bool, run: AxisSignals, force: float, arm: float
) -> Mapping[str, Number]:
    """Return what is fitted; bounds are several times what the record's force, speed and travel allow.

    An `arm` is the stated weight of a turning axis.
    """
    top, travel = float(np.abs(run.velocity).max()), float(np.ptp(run.smooth))
    behind = mass * (ARM**2 if turns else 1.0)

    def damping(spec: mujoco.MjSpec, x: float) -> None:
        spec.joints[0].damping[0] = x

    def stiffness(spec: mujoco.MjSpec, x: float) -> None:
        spec.joints[0].stiffness[0] = x

    def armature(spec: mujoco.MjSpec, x: float) -> None:
        spec.joints[0].armature = x - behind

    def dry(spec: mujoco.MjSpec, x: float) -> None:
        spec.joints[0].frictionloss = x

    def constant(spec: mujoco.MjSpec, x: float) -> None:
        spec.actuators[1].biasprm[0] = -x

    def weight(spec: mujoco.MjSpec, x: float) -> None:
        spec.option.gravity[2] = -x / (mass * ARM)

    most = 5.0 * force
    last = {"arm": Number(arm, arm - most, arm + most, weight)} if turns else {}
    last |= {} if turns else {"spring": Number(0.0, 0.0, 5.0 * most / travel, stiffness)}
    return {
        "mass": Number(1.5 * behind if servo else mass + behind, 1.01 * behind, 20.0 * mass, armature),
        "viscous": Number(0.05 if servo else 0.0, 0.0, 10.0 * force / top + 0.5 * servo, damping),
        "dry": Number(0.0, 0.0, most, dry),
        "constant": Number(0.0, -most, most, constant),
        **last,
    }


def optimised(spec: mujoco.MjSpec, numbers: Mapping[str, Number], run: AxisSignals, drive: Array) -> dict[str, float]:
    """Return the numbers as mujoco.sysid fits them to the positions of a run."""
    model, params = spec.compile(), sysid.ParameterDict()
    for name, x in numbers.items():
        params.add(
            sysid.Parameter(
                name,
                nominal=x.start,
                min_value=x.low,
                max_value=x.high,
                modifier=lambda s, p, put=x.put: put(s, float(np.ravel(p.value)[0])),
            )
        )
    time = np.arange(len(drive)) * run.period
    q, v = run.motor[:, 0], run.velocity[:, 0]
    servo = model.actuator_biastype[0] == mujoco.mjtBias.mjBIAS_AFFINE
    length = min(len(time), round((LONGEST if servo else STRETCH) / run.period))
    stretches = []
    count = 1 if servo else min(STRETCHES, len(time) // length)
    for i, first in enumerate(np.linspace(0, len(time) - length, count).astype(int)):
        here = slice(first, first + length)
        stamps = time[here] - time[first]
        start = sysid.create_initial_state(model, q[here][:1], v[here][:1])
        control = np.column_stack([drive[here], np.zeros(length)])
        series = (
            sysid.TimeSeries.from_control_names(stamps, control, model),
            sysid.TimeSeries.from_names(stamps + model.opt.timestep, q[here][:, None], model),
        )
        stretches.append(sysid.ModelSequences("axis", spec, f"stretch{i}", start, *series))
    residual = sysid.build_residual_fn(models_sequences=stretches)
    params.move_off_bounds()
    with redirect_stdout(StringIO()):
        found, _ = sysid.optimize(params, residual, verbose=False, x_scale="jac", max_iters=ITERATIONS)
    return dict(zip(numbers, map(float, found.as_vector()), strict=True))
