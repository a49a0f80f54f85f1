"""Which setting of MuJoCo makes a trace: the model is run with the trace's controls, each setting changed in turn.

A simulator repeats itself to the last bits, so the right setting leaves next to nothing, whatever contacts do.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_public.records import columns_named

INTEGRATORS = ("Euler", "RK4", "implicit", "implicitfast")
CONES = ("pyramidal", "elliptic")
FINER = (2, 5, 10)
"""By how much a time step may be finer than the stamps."""
LATEST = 20
"""Rows by which commands may be late at most."""
ALIKE = 0.01
"""A replay is the trace where it leaves less than this share of what the two traces differ by. A convention: the right
setting leaves rounding, and a wrong setting leaves as much as the model's own."""

SHOTS = 6
"""Trials for the speed at the start; each leaves a tenth of the error or less."""


@dataclass(frozen=True)
class Played:
    """What a replay needs of a trace: stamps (n,), s; controls (n, nu); positions (n, nq); speeds (n, nv) or None."""

    time: Array
    control: Array
    position: Array
    velocity: Array | None


def played(model: Any, table: Mapping[str, Array]) -> Played | None:
    """Return what a replay needs of the columns (n, ...) of a trace; None where it lacks some in the model's order."""
    control, position, velocity = (
        columns_named(table, names) for names in (("ctrl", "control"), ("qpos", "position"), ("qvel", "velocity"))
    )
    time = table.get("time", table.get("t"))
    if time is None or control is None or position is None:
        return None
    if control.shape[1] != model.nu or position.shape[1] != model.nq or len(time) < 2:
        return None
    return Played(time, control, position, velocity if velocity is not None and velocity.shape[1] == model.nv else None)


class Setting(NamedTuple):
    """A way in which a trace may have been made: options of the model that differ, and by how many rows it was late."""

    name: str
    options: Mapping[str, float] = {}
    late: int = 0


def settings(model: Any, period: float) -> list[Setting]:
    """Return what is tried, the model's own settings first."""
    mujoco = import_module("mujoco")
    damping = model.opt.disableflags ^ int(mujoco.mjtDisableBit.mjDSBL_EULERDAMP)
    state = "off" if damping > model.opt.disableflags else "on"
    return [
        Setting("the model's own settings"),
        *(Setting(f"integrator {name}", {"integrator": i}) for i, name in enumerate(INTEGRATORS)),
        *(Setting(f"friction cone {name}", {"cone": i}) for i, name in enumerate(CONES)),
        *(Setting(f"time step {period / finer:g} s", {"timestep": period / finer}) for finer in FINER),
        Setting(f"implicit damping of Euler {state}", {"disableflags": damping}),
        Setting("rows that were logged after their step", late=-1),
        *(Setting(f"commands {1e3 * late * period:g} ms late", late=late) for late in range(1, LATEST + 1)),
    ]


def makes(model: Any, trace: Played, setting: Setting, within: float) -> bool:
    """Return whether a replay with a setting stays `within` (rad or m, rms over all positions) of the trace.

    It ends where it has left the trace by more than the whole of it may.
    """
    mujoco = import_module("mujoco")
    period = float(np.median(np.diff(trace.time)))
    changed = copy.copy(model)
    changed.opt.timestep = period / max(1, round(period / model.opt.timestep))
    for name, value in setting.options.items():
        setattr(changed.opt, name, value)
    rows = np.clip(np.arange(len(trace.time)) - setting.late, 0, len(trace.time) - 1)
    trace = replace(trace, control=trace.control[rows])
    state, steps = mujoco.MjData(changed), round(period / changed.opt.timestep)
    state.qpos[:], state.qvel[:] = trace.position[0], _speed(mujoco, changed, trace, period, steps)
    spare = within**2 * trace.position.size
    for place, control in zip(trace.position, trace.control, strict=True):
        away = state.qpos - place
        spare -= away @ away
        if not spare > 0.0:  # nor where the replay is no number any more
            return False
        state.ctrl[:] = control
        mujoco.mj_step(changed, state, steps)
    return True


def _speed(mujoco: Any, model: Any, trace: Played, period: float, steps: int) -> Array:
    """Return the speed at the start: the trace's, else the one from which the model reaches its second row."""
    if trace.velocity is not None:
        return trace.velocity[0]
    speed, missed = np.zeros(model.nv), np.zeros(model.nv)
    for _ in range(SHOTS):
        state = mujoco.MjData(model)
        state.qpos[:], state.qvel[:], state.ctrl[:] = trace.position[0], speed, trace.control[0]
        mujoco.mj_step(model, state, steps)
        mujoco.mj_differentiatePos(model, missed, period, state.qpos, trace.position[1])
        speed += missed
    return speed


def setting_of(model: Any, first: Played, second: Played) -> tuple[str, str]:
    """Return the setting that makes each trace, empty where none does."""
    apart = float(np.sqrt(np.mean((first.position - second.position) ** 2)))
    period = float(np.median(np.diff(first.time)))
    if apart == 0.0:
        return "", ""
    return _reproducing_setting(model, first, period, apart), _reproducing_setting(model, second, period, apart)


def _reproducing_setting(model: Any, trace: Played, period: float, apart: float) -> str:
    return next((s.name for s in settings(model, period) if makes(model, trace, s, ALIKE * apart)), "")
