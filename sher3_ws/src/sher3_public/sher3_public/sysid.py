"""What a script of mujoco.sysid holds already, a `ModelSequences`, diagnosed in one call.

Nothing of mujoco.sysid is imported: its objects are read by their attributes `spec`, `control` and `sensordata`, and of
a `TimeSeries` `times`, `data` and `signal_mapping`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np

from sher3_public.answer import Answer
from sher3_public.errors import InputError
from sher3_public.one_call import diagnose
from sher3_public.records import Array

STATE, CONTROL = "MjStateQPos", "MjCtrl"
"""Names of the types of signals that need no sensor of the model."""
FORCES = ("JOINTACTFRC", "ACTUATORFRC")
"""Sensors of MuJoCo whose reading is the force of a drive, at its joint or at the actuator."""

HAIR = 1e-9
"""Seconds by which stamps that are meant to be the same may differ."""
ROLLED = "readings begin a step after the controls: taken as those of a rollout, read a step before their stamps"
"""Guess."""


def from_sysid(
    sequences: Any,
    *,
    tags: Mapping[str, Sequence[object]] | Sequence[Mapping[str, object]] | None = None,
    without: Collection[str] = (),
) -> Answer:
    """Diagnose the measured sequences of a `mujoco.sysid.ModelSequences`; each is a run.

    Positions are those of the sensors `jointpos` or of the state, efforts those of `jointactuatorfrc` or
    `actuatorfrc`; without these they follow from the controls by the laws of the model's actuators. Controls hold until
    the next one. Readings whose first stamp is a step after the first control are those of a rollout, which stamps what
    is read at the beginning of a step with its end.

    Args:
        sequences: with `spec`, `control` and `sensordata`.
        tags: what differs between sequences, as `diagnose` takes it.
        without: ids of effects that are left out of the library.

    Raises:
        InputError: it is no such object, or no joint's position was measured.
        MachineError: as `diagnose` does.
    """
    lacking = [name for name in ("spec", "control", "sensordata") if not hasattr(sequences, name)]
    if lacking:
        value = f"{type(sequences).__name__} without {', '.join(lacking)}"
        raise InputError("these are no ModelSequences", value=value, remedy="give spec, control and sensordata")
    model = sequences.spec.compile()
    runs = [_run(model, *pair) for pair in zip(sequences.control, sequences.sensordata, strict=True)]
    joints = runs[0].joints
    if not joints:
        raise InputError("no joint's position was measured", remedy="add sensors jointpos, or the state, to sensordata")
    columns = [list(x) for x in zip(*((r.time, r.control, r.position, r.effort) for r in runs), strict=True)]
    effort = None if any(x is None for x in columns[3]) else columns[3]
    answer = diagnose(
        sequences.spec, columns[0], columns[1], columns[2], effort, joints=joints, tags=tags, without=without
    )
    guesses = [*answer.guessed, *([ROLLED] if any(r.rolled for r in runs) else [])]
    return replace(answer, case=replace(answer.case, guesses=guesses))


class Measured(NamedTuple):
    """One sequence: joints in the order of the model, stamps (n,), control (n, nu), position and effort (n, k).

    `rolled`: whether the stamps were those of a rollout.
    """

    joints: list[str]
    time: Array
    control: Array
    position: Array
    effort: Array | None
    rolled: bool


def _run(model: Any, control: Any, sensordata: Any) -> Measured:
    step, stamps = float(model.opt.timestep), np.asarray(control.times, dtype=float)
    time = np.asarray(sensordata.times, dtype=float)
    rolled = bool(abs(time[0] - stamps[0] - step) < HAIR)
    time = time - step * rolled
    position, effort = _measured(model, sensordata)
    joints = [name for i in range(model.njnt) if (name := model.joint(i).name) in position]
    known = bool(joints) and set(joints) <= set(effort)
    return Measured(
        joints,
        time,
        held(_controls(model, control), stamps, time),
        np.column_stack([position[name] for name in joints] or [time]),
        np.column_stack([effort[name] for name in joints]) if known else None,
        rolled,
    )


def _signals(series: Any) -> dict[str, tuple[str, Array]]:
    """Return name -> (type of the signal, first column)."""
    data = np.asarray(series.data, dtype=float)
    return {n: (kind.name, data[:, int(np.ravel(at)[0])]) for n, (kind, at) in (series.signal_mapping or {}).items()}


def _measured(model: Any, series: Any) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return joint -> position and joint -> effort, rad or m, N m or N."""
    api = import_module("mujoco")
    position: dict[str, Array] = {}
    effort: dict[str, Array] = {}
    if series.signal_mapping is None:
        data = np.asarray(series.data, dtype=float)
        signals = {model.sensor(i).name: ("MjSensor", data[:, int(model.sensor_adr[i])]) for i in range(model.nsensor)}
    else:
        signals = _signals(series)
    for name, (kind, x) in signals.items():
        if kind == STATE:
            position[name.removesuffix("_qpos")] = x
        elif kind == "MjSensor":
            number = model.sensor(name).id
            type_ = api.mjtSensor(int(model.sensor_type[number])).name.removeprefix("mjSENS_")
            of = int(model.sensor_objid[number])
            if type_ == "JOINTPOS":
                position[model.joint(of).name] = x
            elif type_ == FORCES[0]:
                effort[model.joint(of).name] = x
            elif type_ == FORCES[1]:
                effort[model.joint(int(model.actuator_trnid[of][0])).name] = x * float(model.actuator_gear[of][0])
    return position, effort


def _controls(model: Any, series: Any) -> Array:
    """Return controls (n, nu) in the order of the model."""
    data = np.asarray(series.data, dtype=float).reshape(len(series.times), -1)
    if series.signal_mapping is None:
        return data
    found = {name.removesuffix("_ctrl"): x for name, (kind, x) in _signals(series).items() if kind == CONTROL}
    names = [model.actuator(i).name for i in range(model.nu)]
    missing = [name for name in names if name not in found]
    if missing:
        raise InputError("controls are missing", value=", ".join(missing), remedy="record each actuator's control")
    return np.column_stack([found[name] for name in names])


def held(values: Array, stamps: Array, wanted: Array) -> Array:
    """Return values (n, k) at wanted stamps: each holds until the next; the first one before."""
    return values[np.clip(np.searchsorted(stamps, wanted + HAIR, side="right") - 1, 0, len(stamps) - 1)]
