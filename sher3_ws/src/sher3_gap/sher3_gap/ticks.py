"""The tick grid of a recorded run: holes that a busy machine leaves are bridged and marked, longer ones refused."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sher3_gap.channels import Array
from sher3_gap.errors import CaseError as CaseError

LOST_SHARE = 0.05
"""Share of the ticks that may be missing."""
LONGEST_HOLE = 0.05
"""Seconds without a tick up to which a hole is bridged."""
LEAST_TICKS = 101
Gap = Literal["line", "hold", "next"]
"""What stands in a hole: a straight line, the sample before (commands), or the one after (demand executed since)."""
Stamps = NDArray[np.int64]
Mask = NDArray[np.bool_]


def tick_grid(stamps: Stamps, expected: float, name: str) -> tuple[Stamps, Mask]:
    """Return the stamp of every tick from the first to the last, (n,), and which of them are missing, (n,).

    Raises:
        CaseError: too few ticks, a clock that jumps, another period, or holes beyond what can be bridged.
    """
    steps = np.diff(stamps)
    if len(steps) < LEAST_TICKS - 1:
        remedy = "record longer runs"
        raise CaseError(f"{name}: too short", value=f"{len(stamps)} ticks", limit=f"{LEAST_TICKS} ticks", remedy=remedy)
    if (steps <= 0).any():
        at = int(np.argmax(steps <= 0))
        raise CaseError(f"{name}: the clock jumps back at tick {at}", value=f"{steps[at] * 1e-9:.6f} s", limit="> 0 s")
    period = float(np.median(steps)) * 1e-9
    if abs(period / expected - 1.0) > 0.01:
        raise CaseError(
            f"{name}: tick period differs from robot.yaml's control_period",
            value=f"{period:.6f} s",
            limit=f"{expected:.6f} s",
            remedy="use the robot.yaml that was in force",
        )
    _check_holes(steps, period, name)
    index = np.concatenate([[0], np.cumsum(np.rint(steps * 1e-9 / period).astype(np.int64))])
    grid = np.interp(np.arange(index[-1] + 1), index, (stamps - stamps[0]).astype(float))
    lost = np.ones(len(grid), dtype=bool)
    lost[index] = False
    return stamps[0] + np.rint(grid).astype(np.int64), lost


def _check_holes(steps: Stamps, period: float, name: str) -> None:
    remedy = "cut the run at the hole, or record without drops"
    if steps.max() > 1e9 * LONGEST_HOLE:
        at, value = int(np.argmax(steps)), f"{steps.max() * 1e-9:.6f} s"
        raise CaseError(
            f"{name}: ticks are missing after tick {at}", value=value, limit=f"{LONGEST_HOLE} s", remedy=remedy
        )
    lost = int(np.sum(np.rint(steps * 1e-9 / period) - 1.0))
    if lost > LOST_SHARE * len(steps):
        limit = f"{LOST_SHARE:.0%}"
        raise CaseError(
            f"{name}: ticks are missing", value=f"{lost} of {len(steps) + lost}", limit=limit, remedy=remedy
        )


def on_grid(stamps: Stamps, values: Array, ticks: Stamps, what: str, gap: Gap = "line") -> tuple[Array, Mask]:
    """Return a stream's (n, d) values at the ticks, holes filled, and where it had no sample, (n,).

    Raises:
        CaseError: a value is not finite, or too many samples are missing.
    """
    if not np.isfinite(values).all():
        at = int(np.argmax(~np.isfinite(values).all(axis=1)))
        raise CaseError(f"{what}: not a finite number in sample {at}", value=str(values[at]), remedy="drop this run")
    if len(stamps) == len(ticks) and (stamps == ticks).all():
        return np.ascontiguousarray(values), np.zeros(len(ticks), dtype=bool)
    last = np.clip(np.searchsorted(stamps, ticks, side="right") - 1, 0, len(stamps) - 1)
    missing = stamps[last] != ticks
    if (count := int(missing.sum())) > LOST_SHARE * len(ticks):
        raise CaseError(f"{what}: samples are missing", value=f"{count} of {len(ticks)}", limit=f"{LOST_SHARE:.0%}")
    if gap == "hold":
        return np.ascontiguousarray(values[last]), missing
    if gap == "next":
        after = np.clip(np.searchsorted(stamps, ticks, side="left"), 0, len(stamps) - 1)
        return np.ascontiguousarray(values[after]), missing
    filled = np.stack([np.interp(ticks - ticks[0], stamps - ticks[0], column) for column in values.T], axis=1)
    return filled, missing
