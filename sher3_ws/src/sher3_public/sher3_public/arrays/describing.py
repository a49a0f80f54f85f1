"""The description of an arm from arrays and its model: which column is which joint, what each control stands for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from sher3_chain.manipulator.mjcf.bodies import FREE
from sher3_chain.manipulator.mjcf.drives import Driven
from sher3_chain.manipulator.mjcf.joint import drive_joint
from sher3_machines.drafting.guesses import count_of, scatter
from sher3_machines.intake.tables import Tables

from sher3_public.arrays import plausible
from sher3_public.arrays.degrees import check_degrees
from sher3_public.arrays.own_effort import simulated
from sher3_public.arrays.stating import Stated
from sher3_public.errors import InputError
from sher3_public.models import Source
from sher3_public.records import LEAST, Array, Arrays

LEAST_RESOLUTION = 1e-9
"""Resolution of an encoder whose readings neither step nor scatter, rad or m: a simulator's own numbers."""


@dataclass
class Described:
    """A description as plain data, the columns of every run, and what was guessed."""

    data: dict[str, Any]
    tables: list[Tables]
    guesses: list[str] = field(default_factory=list)


def described(source: Source, runs: Sequence[Arrays], stated: Stated) -> Described:
    """Describe the joints of an arm from runs: positions (n, k), and what was recorded beside them.

    Raises:
        InputError: the arrays do not fit the joints of the model, or cannot be what they would be taken for.
    """
    runs = [stated.in_si(run) for run in runs]
    most = max(len(run.time) for run in runs)
    if most < LEAST:
        raise InputError("too few samples", value=most, limit=LEAST, remedy="record some seconds of motion")
    plausible.stamps(runs[0].time)
    guesses: list[str] = []
    runs = [without_free(source, run, stated.joints, guesses) for run in runs]
    _check_alike(runs)
    names = joints_of(source, runs[0].position.shape[1], stated.joints, guesses)
    stated.check_names(names)
    control = runs[0].control
    drives = stated.drives(source.bodies, names, runs[0])
    guesses += plausible.places(names, runs[0], source.bodies.reach)
    controls = _controls(names, control, drives, source, stated)
    if not stated.controls:
        controls = plausible.columns_of_control(names, controls, runs[0], drives, bool(stated.joints), guesses)
    names, controls, runs = without_followers(source, names, controls, runs, guesses)
    joints = [_joint(name, i, source, runs, stated, controls[i] is not None) for i, name in enumerate(names)]
    for place, (name, column) in enumerate(zip(names, controls, strict=True)):
        drive = drives[name].drive if name in drives else None
        if drive is not None and column is not None and runs[0].control is not None and runs[0].effort is None:
            plausible.control_of(name, runs[0].control[:, column], runs[0].position[:, place], drive)
    guesses += plausible.infinite(runs)
    plausible.held(names, controls, runs[0], drives)
    if "position" not in stated.units and not isinstance(stated.gain, str):
        check_degrees(names, runs[0], controls, source.bodies, drives, guesses)
    own = simulated(joints, names, controls, runs[0], source.bodies.mujoco, drives, stated.simulated, guesses)
    for joint in joints:
        if joint["name"] in drives:
            drive_joint(joint, drives[joint["name"]], own, guesses, float(np.median(np.diff(runs[0].time))))
            stated.delayed(joint, guesses)
        elif "command" in joint["signals"]:
            joint["signals"].pop("command")
            guesses.append(f"{joint['name']}: its control is not used, because the model has no drives; servo=(kp, kv)")
    if runs[0].control is not None:
        unheard = [n for n, c in zip(names, controls, strict=True) if c is None and n in drives]
        guesses += [f"{n}: its control is not used, because {drives[n].reason}" for n in unheard if drives[n].reason]
    source.bodies.at_rest(names, guesses)
    data = {"kind": "manipulator", "name": source.name, "model": source.bodies.label, "time": {"column": "time"}}
    return Described(
        {**data, "inertias": stated.inertias, "joints": joints}, [_table(run, names, controls) for run in runs], guesses
    )


def without_followers(
    source: Source, names: Sequence[str], controls: Sequence[int | None], runs: Sequence[Arrays], guesses: list[str]
) -> tuple[list[str], list[int | None], list[Arrays]]:
    """Return joints, their controls and runs, arrays (n, k), without the joints that follow others of them."""
    led = source.bodies.follow(names, guesses)
    kept = [i for i, name in enumerate(names) if name not in led]

    def cut(x: Array | None) -> Array | None:
        return None if x is None else x[:, kept]

    runs = [replace(x, position=x.position[:, kept], effort=cut(x.effort), load=cut(x.load)) for x in runs]
    return [names[i] for i in kept], [controls[i] for i in kept], runs


def without_free(source: Source, run: Arrays, stated: Sequence[str], guesses: list[str]) -> Arrays:
    """Return a run with the positions (n, joints), where they were MuJoCo's whole `qpos` (n, nq) with free bodies."""
    model, known = source.bodies.mujoco, list(source.bodies.joints)
    if stated or model is None or run.position.shape[1] != model.nq or model.nq == len(known):
        return run
    said = "positions are MuJoCo's whole qpos: those of free bodies are left out"
    guesses += [said] if said not in guesses else []
    own = [int(i) for i in range(model.njnt) if model.jnt_type[i] != FREE]
    run = replace(run, position=run.position[:, model.jnt_qposadr[own]])
    if run.effort is None or run.effort.shape[1] != model.nv:
        return run
    return replace(run, effort=run.effort[:, model.jnt_dofadr[own]])


def _check_alike(runs: Sequence[Arrays]) -> None:
    """Raise InputError where runs have not the same columns, or efforts other ones than positions."""
    remedy = "give one column for each joint; NaN where a joint has none"
    for run in runs:
        wide = run.position.shape
        for name in ("position", "control", "effort", "load"):
            x, first = getattr(run, name), getattr(runs[0], name)
            if (x is None) != (first is None) or (x is not None and x.shape[1] != first.shape[1]):
                value, limit = ("none" if a is None else f"{a.shape[1]} columns" for a in (x, first))
                raise InputError(f"{name} differs between runs", value=value, limit=limit, remedy=remedy)
            if name in ("effort", "load") and x is not None and x.shape != wide:
                raise InputError(f"{name} and position differ in shape", value=x.shape, limit=wide, remedy=remedy)


def joints_of(source: Source, columns: int, stated: Sequence[str], guesses: list[str]) -> list[str]:
    """Return the joint of each column; raises InputError where the columns do not fit."""
    known, drives = list(source.bodies.joints), source.bodies.drives
    if stated:
        wrong = [name for name in stated if name not in known]
        if wrong or len(stated) != columns:
            value = f"{len(stated)} names{f', {wrong[0]!r}' if wrong else ''}"
            limit = f"{columns} columns; joints: {', '.join(known)}"
            raise InputError("joints do not fit the positions", value=value, limit=limit, remedy="name one for each")
        return list(stated)
    driven = [name for name in known if name in drives and drives[name].drive is not None]
    alone = [link.name for link in source.bodies.tree.links if link.gear is None]
    for which, found in (("joints", known), ("driven joints", driven), ("joints that follow no other", alone)):
        if len(found) == columns:
            guesses.append(f"positions are those of the model's {which} in its order: {', '.join(found)}")
            return found
    remedy = "name the joint of each column: joints=[...]"
    limit = f"{len(known)} joints: {', '.join(known[:12])}"
    raise InputError(
        "positions do not fit the joints of the model", value=f"{columns} columns", limit=limit, remedy=remedy
    )


def _controls(
    names: Sequence[str], control: Array | None, drives: Mapping[str, Driven], source: Source, stated: Stated
) -> list[int | None]:
    """Return the column of `control` of each joint, as stated or guessed; raises InputError where they do not fit."""
    if control is not None and stated.controls:
        stated.check_controls(control.shape[1], names, drives)
        return [stated.column(name, drives[name].drive if name in drives else None) for name in names]
    return [control_of(name, i, len(names), control, drives, source) for i, name in enumerate(names)]


def control_of(
    joint: str, place: int, joints: int, control: Array | None, drives: Mapping[str, Driven], source: Source
) -> int | None:
    """Return the column of `control` (n, m) that drives a joint, None for none; raises InputError on a wrong m."""
    if control is None:
        return None
    own = drives[joint].drive if joint in drives else None
    actuators = source.bodies.mujoco.nu if source.bodies.mujoco is not None else 0
    if control.shape[1] == actuators:
        return None if own is None else own.number
    if control.shape[1] == joints:
        return place
    limit = f"{actuators} actuators or {joints} joints"
    remedy = "give one column for each actuator of the model, or for each joint"
    raise InputError("control does not fit", value=f"{control.shape[1]} columns", limit=limit, remedy=remedy)


def _joint(
    name: str, place: int, source: Source, runs: Sequence[Arrays], stated: Stated, controlled: bool
) -> dict[str, Any]:
    slides = source.bodies.joints[name]
    unit, force = ("m", "N") if slides else ("rad", "N*m")
    signals = {"position": {"column": f"{name}.position", "unit": unit}}
    for signal, own in (("effort", force), ("load", unit)):
        x = getattr(runs[0], signal)
        if x is not None and np.isfinite(x[:, place]).any():
            signals[signal] = {"column": f"{name}.{signal}", "unit": own}
    if controlled:
        signals["command"] = {"column": f"{name}.control", "unit": "1"}
    out: dict[str, Any] = {"name": name, "motion": "linear" if slides else "rotary", "signals": signals}
    out["encoder_resolution"] = stated.resolution or resolution(runs[0].position[:, place])
    gain = stated.gain.get(name, 1.0) if isinstance(stated.gain, Mapping) else stated.gain
    return out if gain == 1.0 else {**out, "gain": gain}


def resolution(x: Array) -> float:
    """Return the count of an encoder of readings (n,), rad or m: its smallest step, else its scatter."""
    x = x[np.isfinite(x)]
    return float(f"{max(count_of(x) or scatter(x), LEAST_RESOLUTION):.6g}")


def _table(run: Arrays, names: Sequence[str], controls: Sequence[int | None]) -> Tables:
    out: dict[str, Array] = {"time": run.time}
    for place, (name, column) in enumerate(zip(names, controls, strict=True)):
        for signal in ("position", "effort", "load"):
            x = getattr(run, signal)
            if x is not None:
                out[f"{name}.{signal}"] = x[:, place]
        if run.control is not None and column is not None:
            out[f"{name}.control"] = run.control[:, column]
    return out
