"""What the recorded motion says of columns beside it: whether a speed agrees with the clock, the sense of a place, the
sign of an effort.
"""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_machines.errors import MachineError
from sher3_machines.intake.fields import TIME_UNITS

AGREES = 0.1
"""Share by which the way and the integral of the speed may differ: a filter of the speed takes a few per cent."""
FOLLOWS = 0.9
"""Correlation of way and integral below which a speed says nothing: it is dead, or of another axis."""
SMOOTHED = 9
"""Samples over which a speed is taken."""
MOVING = 0.02
"""Share of the usual speed below which an axis stands: its sign is then that of the motion before."""
CLEARER = 0.5
"""Residual of an effort with the signs of the motion over its residual as recorded, below which it is a magnitude."""


def speed_of(t: Array, x: Array) -> Array:
    """Return the speed (n,) of positions (n,) at stamps (n,), over nine samples."""
    half = min(SMOOTHED // 2, max((len(x) - 1) // 2, 1))
    low, high = np.maximum(np.arange(len(x)) - half, 0), np.minimum(np.arange(len(x)) + half, len(x) - 1)
    return np.asarray((x[high] - x[low]) / (t[high] - t[low]))


def speed_ratio(t: Array, x: Array, v: Array) -> float | None:
    """Return how far positions (n,) move over the integral of speeds (n,) at stamps (n,); None where they do not agree.

    It is the slope of the positions over that integral, with a constant and a drift fitted beside it, so that an offset
    of the speed does not count.
    """
    way = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t))])
    drift = np.column_stack([np.ones(len(t)), t - t.mean()])
    left = [y - drift @ np.linalg.lstsq(drift, y, rcond=None)[0] for y in (way, x)]
    norms = [float(np.linalg.norm(y)) for y in left]
    if min(norms) == 0.0 or abs(float(left[0] @ left[1])) < FOLLOWS * norms[0] * norms[1]:
        return None
    return float(left[0] @ left[1]) / norms[0] ** 2


def counts_backwards(other: Array, x: Array) -> bool:
    """Return whether a second place (n,) counts against the first one (n,): it follows it well, the other way."""
    if not (np.ptp(x) > 0.0 and np.ptp(other) > 0.0):
        return False
    return float(np.corrcoef(other, x)[0, 1]) < -FOLLOWS


def check_speed(ratio: float | None, unit: str | None, what: str) -> None:
    """Refuse a clock, or units, that a recorded speed contradicts.

    Args:
        ratio: as `speed_ratio` returns it, in SI units.
        unit: of the stamps; None: no stamps.
        what: run, axis and column, for the message.

    Raises:
        MachineError: the ratio is not one; the remedy names the unit of the clock that would make it one.
    """
    if ratio is None or abs(ratio - 1.0) < AGREES:
        return
    likely = likely_unit(ratio, unit)
    remedy = (
        f"the stamps seem to be in {likely}: `time: {{unit: {likely}, override: true}}`"
        if likely
        else "correct the unit of the time, the position or the velocity, or leave the velocity out"
    )
    raise MachineError(
        f"{what} and the clock do not agree",
        value=f"the position moves {ratio:.4g} times as far as the velocity says",
        limit=f"{1.0 - AGREES:g} to {1.0 + AGREES:g} times",
        remedy=remedy,
    )


def likely_unit(ratio: float, unit: str | None) -> str | None:
    """Return the unit of stamps that makes a ratio of `speed_ratio` one; None where there is none."""
    wanted = ratio * TIME_UNITS[unit] if unit is not None else float("nan")
    return next((name for name, scale in TIME_UNITS.items() if abs(wanted / scale - 1.0) < AGREES), None)


def signs_of(t: Array, x: Array) -> Array:
    """Return the direction of motion (n,), +1 or -1; where an axis stands that of the motion before."""
    v = speed_of(t, x)
    moving = np.abs(v) > MOVING * float(np.quantile(np.abs(v), 0.9))
    last = np.maximum.accumulate(np.where(moving, np.arange(len(v)), 0))
    return np.where(v[last] < 0.0, -1.0, 1.0)


def is_magnitude(t: Array, x: Array, effort: Array) -> bool:
    """Return whether an effort (n,) is a magnitude: never below zero, and clearer with the signs of the motion.

    Both are fitted by a constant, the signs, speed, acceleration and position. A weight alone keeps an effort above
    zero too: then the numbers as recorded are as clear.
    """
    signs = signs_of(t, x)
    if float(effort.min()) < 0.0 or not float(effort.max()) > 0.0 or abs(float(signs.mean())) > FOLLOWS:
        return False
    v = speed_of(t, x)
    model = np.column_stack([np.ones(len(t)), signs, v, speed_of(t, v), x])
    model = model / np.maximum(np.abs(model).max(axis=0), np.finfo(float).tiny)
    left = [y - model @ np.linalg.lstsq(model, y, rcond=None)[0] for y in (effort, effort * signs)]
    return float(np.var(left[1])) < CLEARER * float(np.var(left[0]))
