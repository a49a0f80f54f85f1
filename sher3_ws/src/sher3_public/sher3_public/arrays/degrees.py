"""Angles in degrees that go no further than radians might: the forces of the arm tell them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from sher3_chain.manipulator.bodies import Bodies
from sher3_chain.manipulator.evidence import DROWNED
from sher3_chain.manipulator.mjcf.drives import Driven
from sher3_chain.manipulator.model import arm_model
from sher3_common.numbers.smoothing import savitzky_golay

from sher3_public.arrays.own_effort import LOOKED_AT, WINDOW
from sher3_public.errors import InputError
from sher3_public.records import Array, Arrays

FURTHEST = 1.0
"""Largest place, rad, up to which nobody asks: a joint that moves within a degree tells nothing."""
BETTER = 0.35
"""Share of what the model leaves of efforts in radians that it leaves in degrees at most, in the mean of the joints.
Where angles are right the other unit leaves two to a hundred times more."""


def check_degrees(
    names: Sequence[str],
    run: Arrays,
    controls: Sequence[int | None],
    bodies: Bodies,
    drives: Mapping[str, Driven],
    guesses: list[str],
) -> None:
    """Raise InputError where the model explains the efforts far better with angles (n, k) in degrees.

    Efforts in a unit of their own, such as those before a gear, are in proportion to what the model needs in radians.
    They do not speak for degrees.

    The forces of servos grow with the unit of the angle. There the weight alone tells the units apart, and a robot may
    weigh more or less than its model: within half a turn degrees are a guess and no error.

    Args:
        names: of the joints, one for each column of the positions.
        run: that is looked at.
        controls: column of `control` of each joint, None where it has none.
        bodies: of the model.
        drives: joint -> how it is driven.
        guesses: so far.
    """
    turns = [i for i, name in enumerate(names) if not bodies.joints[name]]
    most = float(np.nanmax(np.abs(run.position[:, turns]), initial=0.0))
    known = np.isfinite(run.position).all() and np.isfinite(run.time).all() and len(run.time) > 3 * WINDOW
    if most < FURTHEST or not known or drowned(run.position[:, turns]):
        return
    radians, degrees = (residual_share(names, run, controls, bodies, drives, x)[turns] for x in (1.0, np.pi / 180.0))
    compared = np.isfinite(radians)
    better = np.log(degrees[compared] / radians[compared])
    if not compared.any() or better.max() > 0.0 or better.mean() > np.log(BETTER):
        return
    value = f"{degrees[compared].max():.2g} of the efforts left in degrees"
    said = "units={'position': 'deg', 'control': 'deg'}"
    if run.effort is None and most < np.pi:
        guesses.append(f"positions are in rad; in degrees the model would leave less of its forces, {value}: {said}")
        return
    limit = f"{radians[compared].min():.2g} left in rad"
    raise InputError("positions are likely in degrees", value=value, limit=limit, remedy=f"give rad, or {said}")


def drowned(position: Array) -> bool:
    """Return whether no force follows from positions (n, k) for their noise: any smaller unit then looks better."""
    course = savitzky_golay(position, WINDOW, 3)
    return float((position - course).std(axis=0).max()) > DROWNED * float(course.std(axis=0).max())


def residual_share(
    names: Sequence[str],
    run: Arrays,
    controls: Sequence[int | None],
    bodies: Bodies,
    drives: Mapping[str, Driven],
    scale: float,
) -> Array:
    """Return the share (joints,) of each joint's effort that model and friction leave, with angles times a scale.

    NaN where no effort is known. In radians recorded efforts may be in a unit of their own.
    """
    period = float(np.median(np.diff(run.time)))
    sizes = np.array([1.0 if bodies.joints[name] else scale for name in names])
    q, v, a = (sizes * savitzky_golay(run.position, WINDOW, 3, k, period) for k in (0, 1, 2))
    inner = np.arange(WINDOW, len(q) - WINDOW, max(1, len(q) // LOOKED_AT))
    needed = arm_model(bodies, names, None).needed(*(x[inner] for x in (q, v, a)))
    out = np.full(len(names), np.nan)
    for i, name in enumerate(names):
        column, drive = controls[i], drives[name].drive if name in drives else None
        added = 0.0
        if run.effort is not None:
            effort, own = run.effort[:, i], ([needed[:, i]] if scale == 1.0 else [])
        elif run.control is None or column is None or drive is None:
            continue
        else:
            asked = drive.target(run.control[:, column]) * (sizes[i] if drive.servo else 1.0)
            effort = drive.law(asked, q[:, i], v[:, i])
            added, own = drives[name].of_law.inertia if drive.servo else 0.0, []
        effort = savitzky_golay(effort, WINDOW, 3)[inner]
        beside = np.column_stack([v[inner, i], np.sign(v[inner, i]), np.ones(len(inner)), *own])
        rest = effort - needed[:, i] - added * a[inner, i]
        rest = rest - beside @ np.linalg.lstsq(beside, rest, rcond=None)[0]
        out[i] = np.std(rest) / max(float(np.std(effort)), np.finfo(float).tiny)
    return out
