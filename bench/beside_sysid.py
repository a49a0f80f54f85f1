"""The published examples, and ten drawn arms with a structural fault each, beside mujoco.sysid: needs `sher3[sysid]`.

Of the arms both get the same log of the same faulty arm and the healthy model. mujoco.sysid fits what a user would give
it: mass of each link, damping, dry friction, armature and spring of each joint and the gain of each drive. The
diagnosis is given nothing. Another motion, not seen by either, tells what each corrected model is worth. Then come
drawn axes and servos of several causes each, as `drawn_machines.py --sysid` has them.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from typing import NamedTuple

import mujoco
import numpy as np
import sher3.gap as gap
from numpy.typing import NDArray
from sher3_diagnosis.verdict import Verdict
from sher3_public.errors import InputError
from sysid_examples import lines_of
from sysid_examples import table as examples

sys.path.append(str(Path(__file__).parents[1] / "sher3_ws/src/sher3_chain/test"))

from drawn_arms import METHODS, NOISE, asked, drawn_xml, served

os.environ.setdefault("ABSL_LOGGING_VERBOSITY", "-1")

Array = NDArray[np.float64]
FIRST = 1200
"""First seed: none of the tests'."""
SECONDS, HELD_OUT = 8.0, 9000
"""Length of a motion, s, and what is added to a seed for the one held out."""
LATE = 12
"""Steps by which a late control acts."""
NUMBERS = 6
"""Numbers of a joint that mujoco.sysid is given to fit."""
SURE = 3.0
"""Standard errors by which a parameter must move to be read as a finding of a fit."""
FAULTS = (
    "viscous",
    "coulomb",
    "stribeck",
    "cogging",
    "late command",
    "load friction",
    "spring",
    "rotor",
    "payload",
    "gain",
)
"""What is hidden in arms 0 to 9, at a drawn joint; MuJoCo has no field for the third to the sixth."""
TOLD = {
    "viscous": ("viscous_friction", "extra"),
    "coulomb": ("coulomb_friction", "force"),
    "stribeck": ("stribeck_friction", "force"),
    "cogging": ("cogging", "amplitude"),
    "late command": ("command_delay", "reference_delay"),
    "load friction": ("gear_loss", "share"),
    "spring": ("spring_torque", "stiffness"),
    "rotor": ("rotor_inertia", "inertia"),
    "payload": ("payload_mass", "mass"),
    "gain": ("controller_gain", "relative"),
}
"""Fault -> effect and parameter that tell its size."""
FITTED = {
    "viscous": "damping",
    "coulomb": "frictionloss",
    "spring": "stiffness",
    "rotor": "armature",
    "payload": "mass",
    "gain": "gain",
}
"""Fault -> number that mujoco.sysid is given, by which it might be told."""


class Log(NamedTuple):
    """A motion: stamps (n,), controls (n, k), positions (n, k) with noise and forces of the drives (n, k)."""

    time: Array
    ctrl: Array
    qpos: Array
    force: Array


class Hidden(NamedTuple):
    """A fault: what it is, the joint it is at, and its size as a share of what is drawn."""

    kind: str
    joint: int
    size: float


def true_size(fault: Hidden, step: float) -> float:
    """Return the size of a fault, SI units; of Stribeck friction its level at speed."""
    scale = 0.5**fault.joint
    each = {
        "viscous": 2.0 * scale,
        "coulomb": scale,
        "stribeck": 0.5 * scale,
        "cogging": scale,
        "load friction": 0.2,
        "spring": 6.0 * scale,
        "rotor": 0.1 * scale,
        "payload": 0.5,
        "gain": -0.2,
    }
    return LATE * step if fault.kind == "late command" else each[fault.kind] * fault.size


def off_by(found: float | None, true: float) -> str:
    """Return by how much a found size is off, in words."""
    return "-" if found is None else f"{abs(found / true - 1.0):.1%}"


def named(verdict: Verdict, fault: Hidden) -> float | None:
    """Return the size that a verdict gives of a fault; None where it does not name it."""
    effect, parameter = TOLD[fault.kind]
    return next((float(c.parameters[parameter].value) for c in verdict.causes if c.effect == effect), None)


def faulty(xml: str, fault: Hidden) -> mujoco.MjModel:
    """Return the arm with what its file can say of the fault."""
    spec = mujoco.MjSpec.from_string(xml)
    joint, scale = spec.joints[fault.joint], 0.5**fault.joint
    if fault.kind == "viscous":
        joint.damping[0] += 2.0 * fault.size * scale
    elif fault.kind == "coulomb":
        joint.frictionloss += 1.0 * fault.size * scale
    elif fault.kind == "spring":
        joint.stiffness[0] += 6.0 * fault.size * scale
    elif fault.kind == "rotor":
        joint.armature += 0.1 * fault.size * scale
    elif fault.kind == "payload":
        tip = spec.bodies[-1]
        tip.add_geom(
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=[0.01, 0, 0],
            pos=[0.25, 0, 0],
            mass=fault.size * 0.5,
            contype=0,
            conaffinity=0,
        )
    elif fault.kind == "gain":
        drive = spec.actuators[fault.joint]
        drive.gainprm[0] *= 1.0 - 0.2 * fault.size
        drive.biasprm[1:3] *= 1.0 - 0.2 * fault.size
    return spec.compile()


def unsaid(fault: Hidden, q: float, v: float, need: float) -> float:
    """Return the force on the joint that no field of MuJoCo says, N m."""
    scale, sign = 0.5**fault.joint, np.tanh(v / 0.01)
    laws = {
        "stribeck": -fault.size * scale * (0.5 + np.exp(-abs(v) / 0.1)) * sign,
        "cogging": fault.size * scale * 1.0 * np.sin(12.0 * q),
        "load friction": -0.2 * fault.size * abs(need) * sign,
    }
    return float(laws.get(fault.kind, 0.0))


def moved(model: mujoco.MjModel, seed: int, fault: Hidden) -> Log:
    """Run a faulty arm along drawn sines; its position servos follow."""
    rng, place = np.random.default_rng(seed), fault.joint
    stamps = np.arange(round(SECONDS / model.opt.timestep)) * model.opt.timestep
    ctrl = asked(rng, stamps, model.nu) * model.actuator_gear[:, 0]

    def push(data: mujoco.MjData) -> float:
        return unsaid(fault, data.qpos[place], data.qvel[place], data.qfrc_actuator[place])

    qpos, force = served(model, ctrl, place, LATE if fault.kind == "late command" else 0, push)
    return Log(stamps, ctrl, qpos + NOISE * rng.standard_normal(qpos.shape), force)


def put(joint: mujoco.MjsJoint, what: str, value: float) -> None:
    """Set a number of a joint; damping and stiffness are polynomials, whose first coefficient it is."""
    if np.ndim(getattr(joint, what)):
        getattr(joint, what)[0] = value
    else:
        setattr(joint, what, value)


def fitted(xml: str, log: Log) -> tuple[mujoco.MjModel, list[str], dict[str, float]]:
    """Return the model as mujoco.sysid fits it, the numbers that moved by more than three standard errors, and all."""
    from mujoco import sysid

    spec = mujoco.MjSpec.from_string(xml)
    for joint in spec.joints:
        spec.add_sensor(
            name=f"{joint.name}_pos",
            type=mujoco.mjtSensor.mjSENS_JOINTPOS,
            objtype=mujoco.mjtObj.mjOBJ_JOINT,
            objname=joint.name,
        )
    for i, (body, drive) in enumerate(zip(spec.bodies[1:], spec.actuators, strict=True)):
        body.name, drive.name = f"link{i}", f"drive{i}"
        spec.add_sensor(
            name=f"drive{i}_force",
            type=mujoco.mjtSensor.mjSENS_ACTUATORFRC,
            objtype=mujoco.mjtObj.mjOBJ_ACTUATOR,
            objname=drive.name,
        )
    model = spec.compile()
    params = sysid.ParameterDict()

    def add(name: str, nominal: float, low: float, high: float, setter: Callable[..., None]) -> None:
        params.add(sysid.Parameter(name, nominal=nominal, min_value=low, max_value=high, modifier=setter))

    for i, joint in enumerate(spec.joints):
        for what, most in (("damping", 10.0), ("frictionloss", 5.0), ("armature", 1.0), ("stiffness", 30.0)):
            value = float(np.ravel(getattr(joint, what))[0])
            add(
                f"{joint.name} {what}",
                value,
                0.0,
                most,
                lambda s, p, i=i, what=what: put(s.joints[i], what, p.value[0]),
            )
        mass = float(spec.bodies[i + 1].geoms[0].mass)
        add(
            f"link{i} mass",
            mass,
            0.2 * mass,
            5.0 * mass,
            lambda s, p, i=i: setattr(s.bodies[i + 1].geoms[0], "mass", p.value[0]),
        )
        kp, kv = spec.actuators[i].gainprm[0], -spec.actuators[i].biasprm[2]

        def gain(s, p, i=i, kp=kp, kv=kv):
            s.actuators[i].gainprm[0] = kp * p.value[0]
            s.actuators[i].biasprm[1:3] = [-kp * p.value[0], -kv * p.value[0]]

        add(f"{joint.name} gain", 1.0, 0.3, 2.0, gain)
    start = sysid.create_initial_state(model, log.qpos[0], np.zeros(model.nv))
    later = log.time + model.opt.timestep  # its rollouts give readings of the start of a step the stamp of its end
    series = (
        sysid.TimeSeries.from_control_names(log.time, log.ctrl, model),
        sysid.TimeSeries.from_names(later, np.hstack([log.qpos, log.force]), model),
    )
    sequences = sysid.ModelSequences("arm", spec, "motion", start, *series)
    residual = sysid.build_residual_fn(models_sequences=[sequences])
    before = params.as_vector().copy()
    params.move_off_bounds()
    with redirect_stdout(StringIO()):  # it prints a line for each step, verbose or not
        found, result = sysid.optimize(params, residual, verbose=False, x_scale="jac", max_iters=50)
    jac, x = np.asarray(result.jac), found.as_vector()
    left = np.concatenate([np.ravel(r) for r in residual(x, found)[0]])
    error = np.sqrt(np.abs(np.diag(np.linalg.pinv(jac.T @ jac))) * (left @ left) / max(1, len(left) - len(x)))
    names = list(params.parameters)
    told = [
        n
        for n, a, b, e in zip(names, before, x, error, strict=True)
        if abs(b - a) > SURE * e and abs(b - a) > 1e-3 * max(abs(a), 1e-2)
    ]
    done = sysid.apply_param_modifiers(found, spec)
    by = dict(zip(names, map(float, x - before), strict=True))
    return (done if isinstance(done, mujoco.MjModel) else done.compile()), told, by


def rolled(model: mujoco.MjModel, log: Log) -> float:
    """Return the rms of what a model does on the controls of a log against what was measured, rad."""
    data, left = mujoco.MjData(model), []
    for ctrl, qpos in zip(log.ctrl, log.qpos, strict=True):
        data.ctrl[:] = ctrl
        left.append(data.qpos[: model.nu] - qpos)
        mujoco.mj_step(model, data)
    return float(np.sqrt(np.mean(np.square(left))))


def diagnosed(xml: str, log: Log) -> gap.Answer:
    """Return the answer of the diagnosis."""
    columns = {"time": log.time, "ctrl": log.ctrl, "qpos": log.qpos, "actuator_force": log.force}
    return gap.diagnose(xml, columns)


def arm(seed: int, kind: str) -> str:
    """Return a row of the table."""
    rng = np.random.default_rng(seed)
    xml = drawn_xml(rng, servo=True, joints=3, methods=METHODS[:3])  # those that the published table was drawn of
    fault = Hidden(kind, int(rng.integers(3)) if kind != "payload" else 2, float(rng.uniform(0.4, 1.0)))
    nominal, real = mujoco.MjModel.from_xml_string(xml), faulty(xml, fault)
    seen, other = moved(real, seed, fault), moved(real, seed + HELD_OUT, fault)
    untuned, true = rolled(nominal, other), true_size(fault, nominal.opt.timestep)
    began = time.perf_counter()
    theirs, told, by = fitted(xml, seen)
    seconds = time.perf_counter() - began
    began = time.perf_counter()
    answer = diagnosed(xml, seen)
    own_seconds = time.perf_counter() - began
    try:
        ours = f"{rolled(mujoco.MjModel.from_xml_string(answer.corrected().text), other) / untuned:.2f}"
    except (InputError, ValueError) as error:
        ours = type(error).__name__
    joint = nominal.joint(fault.joint).name
    place = f"link{fault.joint}" if kind == "payload" else joint
    cells = (
        f"{kind}, {joint}",
        f"{len(told)} of {NUMBERS * nominal.nu} numbers moved",
        off_by(by.get(f"{place} {FITTED.get(kind)}"), true),
        f"{rolled(theirs, other) / untuned:.2f}",
        f"{seconds:.0f} s",
        answer.headline,
        off_by(named(answer.verdict, fault), true),
        ours,
        f"{own_seconds:.1f} s",
    )
    return f"| {' | '.join(cells)} |"


def arms(count: int) -> None:
    """Print the table of the drawn arms."""
    print(f"Lines beyond model and data: {lines_of(fitted)} and {lines_of(diagnosed)}.\n")
    print("| hidden | mujoco.sysid | size off by | error held out | | here | size off by | error held out | |")
    print("|---|---|---|---|---|---|---|---|---|")
    for i in range(count):
        print(arm(FIRST + i, FAULTS[i % len(FAULTS)]), flush=True)


def machines(count: int) -> None:
    """Print recall, precision and wrong causes on drawn axes and servos, here and by mujoco.sysid."""
    from drawn_machines import SYSID, rows_of, score_of

    for kind in ("axis", "servo"):
        rows = rows_of(kind, range(FIRST, FIRST + count), None, sysid=True)
        for name in ("sher3", SYSID):
            print(f"{kind}, {name}: {score_of(rows, name).line()}", flush=True)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--arms", type=int, default=len(FAULTS))
    parser.add_argument("--machines", type=int, default=4, help="drawn axes, and as many servos")
    asked_for = parser.parse_args()
    examples()
    arms(asked_for.arms)
    machines(asked_for.machines)


if __name__ == "__main__":
    main()
