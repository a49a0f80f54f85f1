"""Whether efforts are a simulator's own, computed at the beginning of its steps, or were measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from typing import Any

import numpy as np
from sher3_chain.manipulator.mjcf.drives import Drive, Driven
from sher3_chain.manipulator.mjcf.reading import mujoco
from sher3_common.numbers.smoothing import savitzky_golay

from sher3_public.records import Array, Arrays

LIKE_ITS_LAW = 0.02
"""Share of an effort's scatter by which it may differ from the law of its drive and be the simulator's own. Recorded
torques of real drives differ by a tenth and more; rounding and an encoder's noise by less than a hundredth."""
WINDOW = 21
"""Samples, at least, over which readings are smoothed before they are compared with a law; every run has as many."""
SMOOTH = 0.04
"""Seconds of that at least: readings that come faster bring more noise to a speed."""
USUAL = 0.9
"""Share of the samples that are held against a law: a start with a jump is faster than what is smoothed."""
LOOKED_AT = 4000
"""Samples at most at which an effort without a control is held against the model."""
LIKE_A_STEP = 0.2
"""An effort may move more inertia than the model has. The step of the integrator made the excess if it differs from
what a step adds by less than this share: a rotor that nobody modelled has no reason to weigh half a time step times the
servo's gain."""
NAMED = "simulated=True or False"


def simulated(
    joints: Sequence[Mapping[str, Any]],
    names: Sequence[str],
    controls: Sequence[int | None],
    run: Arrays,
    model: Any,
    drives: Mapping[str, Driven],
    stated: bool | None,
    guesses: list[str],
) -> bool:
    """Return whether the efforts (n, k) are a simulator's own.

    As stated; else where half of them or more are those of their drives' laws, since a gain may be what is wrong of
    some; without controls, where half of the joints move beyond the model's inertia what a step of its integrator adds.
    """
    if stated is not None:
        return stated
    if run.effort is None or len(run.time) < WINDOW:
        return False
    if run.control is None:
        return _alone(names, run, model, drives, guesses)
    off = []
    for place, (name, column) in enumerate(zip(names, controls, strict=True)):
        drive = drives[name].drive if name in drives else None
        if drive is None or column is None or "effort" not in joints[place]["signals"]:
            continue
        off.append(from_law(run.time, run.position[:, place], drive, run.control[:, column], run.effort[:, place]))
    usual = sorted(off)[(len(off) - 1) // 2] if off else np.inf
    own = usual < LIKE_ITS_LAW
    if off:
        kind = "a simulator's own" if own else "measured"
        why = f"of half of the joints differ by {usual:.2g} of their scatter at most from the law of their drives"
        guesses.append(f"efforts are {kind}: they {why}; {NAMED}")
    return own


def from_law(time: Array, q: Array, drive: Drive, control: Array, effort: Array) -> float:
    """Return by how much an effort (n,) differs from its drive's law, over its own scatter.

    Encoder noise is smoothed away, and what half a step of delay in the law's speed adds, a share of the acceleration,
    is taken off.
    """
    period, limit = float(np.median(np.diff(time))), np.inf if drive.limit is None else drive.limit
    window = min(max(WINDOW, 2 * round(0.5 * SMOOTH / period) + 1), 2 * ((len(q) - 1) // 2) + 1)
    v, a = (savitzky_golay(q, window, 3, k, period) for k in (1, 2))
    law = drive.law(drive.target(control), q, v)
    left = savitzky_golay(effort - np.clip(law, -limit, limit), window, 3)
    usual = np.abs(left) <= np.quantile(np.abs(left), USUAL)
    left, a = left[usual], a[usual]
    left = left - a * (left @ a) / max(a @ a, np.finfo(float).tiny)
    return float(np.std(left) / max(np.std(effort), np.finfo(float).tiny))


def _alone(names: Sequence[str], run: Arrays, model: Any, drives: Mapping[str, Driven], guesses: list[str]) -> bool:
    """Return whether half of the efforts or more are the model's own, which a step of its integrator makes larger."""
    added = {name: drives[name].recorded.inertia for name in names if name in drives}
    if not any(added.values()) or run.effort is None:
        return False
    late = max(drives[name].recorded.late for name in added)
    beyond = beyond_model(names, run, model, late)
    like = [abs(beyond[name] / x - 1.0) < LIKE_A_STEP for name, x in added.items() if x]
    own = 2 * sum(like) >= len(like)
    said = "a simulator's own: they move" if own else "measured: they do not move"
    guesses.append(f"efforts are {said} beyond the model's inertia what a step of it adds; {NAMED}")
    return own


def beyond_model(names: Sequence[str], run: Arrays, model: Any, late: float = 0.0) -> dict[str, float]:
    """Return joint -> inertia that its effort, `late` by so many s, moves beyond an `MjModel`'s, kg or kg m^2.

    What else may be wrong there (friction, a spring, weight) is fitted beside it.
    """
    api, held, period = mujoco(), copy(model), float(np.median(np.diff(run.time)))
    flags = api.mjtDisableBit
    held.opt.disableflags |= int(flags.mjDSBL_CONTACT) | int(flags.mjDSBL_LIMIT)
    held.opt.enableflags &= ~int(api.mjtEnableBit.mjENBL_INVDISCRETE)
    q, v, a = (savitzky_golay(run.position, WINDOW, 3, k, period) for k in (0, 1, 2))
    assert run.effort is not None
    acted = np.column_stack([np.interp(run.time, run.time + late, x) for x in run.effort.T])
    effort = savitzky_golay(acted, WINDOW, 3)
    joints = [held.joint(name) for name in names]
    places, rows = [int(j.qposadr[0]) for j in joints], [int(j.dofadr[0]) for j in joints]
    state, inner = api.MjData(held), np.arange(WINDOW, len(q) - WINDOW, max(1, len(q) // LOOKED_AT))
    left = np.empty((len(inner), len(names)))
    for i, k in enumerate(inner):
        state.qpos[places], state.qvel[rows], state.qacc[rows] = q[k], v[k], a[k]
        api.mj_inverse(held, state)
        left[i] = effort[k] - state.qfrc_inverse[rows]
    return {name: _slope(left[:, i], *(x[inner, i] for x in (a, v, q))) for i, name in enumerate(names)}


def _slope(left: Array, a: Array, v: Array, q: Array) -> float:
    """Return what of a force (n,) goes with the acceleration, beside friction, a spring and a constant."""
    known = np.isfinite(left) & np.isfinite(a)
    shapes = np.column_stack([a, v, np.sign(v), q, np.ones_like(a)])[known]
    return float(np.linalg.lstsq(shapes, left[known], rcond=None)[0][0]) if known.any() else 0.0
