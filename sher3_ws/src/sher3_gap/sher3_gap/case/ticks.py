"""The tick grid of a recorded run: holes that a busy machine leaves are bridged and marked, longer ones refused."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from sher3_bags import Run, Stream
from sher3_diagnosis.channel import Array

from sher3_gap.errors import CaseError

LOST_SHARE = 0.05
"""Share of the ticks that may be missing."""
LONGEST_HOLE = 0.08
"""Seconds without a tick up to which a hole is bridged."""
LEAST_TICKS = 101
LIVELY = 2e4
"""Spread of the time from stamp to arrival [ns] from which a recording is a live one."""
Gap = Literal["line", "hold", "next"]
"""What stands in a hole: a straight line, the sample before (commands), or the one after (demand executed since)."""
Stamps = NDArray[np.int64]
Mask = NDArray[np.bool_]


def in_order(run: Run) -> Run:
    """Return a run whose streams follow their stamps: samples that arrived late are put in place, second ones dropped.

    A stamp further back than `LONGEST_HOLE` is a clock that jumps, and stays for `tick_grid` to refuse.
    """
    return replace(run, streams={topic: _in_order(s) for topic, s in run.streams.items()})


def _in_order(stream: Stream) -> Stream:
    steps = np.diff(stream.stamp)
    if "data" in stream.columns or not len(steps) or steps.min() > 0 or steps.min() < -1e9 * LONGEST_HOLE:
        return stream
    stamps, first = np.unique(stream.stamp, return_index=True)
    columns = {name: np.asarray(values)[first] for name, values in stream.columns.items()}
    logged = None if stream.log_time is None else stream.log_time[first]
    return Stream(stream.type, stamps, stream.frame_id, columns, logged)


def is_live(run: Run) -> bool:
    """Whether a run was recorded as it happened: samples arrive after their stamps, not all by the same time."""
    if run.metadata.origin == "robot":
        return True
    stream = run.streams.get("servo_jv")
    return stream is not None and stream.log_time is not None and float(np.std(stream.log_time - stream.stamp)) > LIVELY


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
        raise CaseError(
            f"{name}: the clock jumps back at tick {at}",
            value=f"{steps[at] * 1e-9:.6f} s",
            limit="> 0 s",
            remedy="cut the run there",
        )
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
    check_finite(what, values)
    if len(stamps) == len(ticks) and (stamps == ticks).all():
        return np.ascontiguousarray(values), np.zeros(len(ticks), dtype=bool)
    last = np.clip(np.searchsorted(stamps, ticks, side="right") - 1, 0, len(stamps) - 1)
    missing = stamps[last] != ticks
    if (count := int(missing.sum())) > LOST_SHARE * len(ticks):
        raise CaseError(
            f"{what}: samples are missing",
            value=f"{count} of {len(ticks)}",
            limit=f"{LOST_SHARE:.0%}",
            remedy="leave the run out, or record without drops",
        )
    if gap == "hold":
        return np.ascontiguousarray(values[last]), missing
    if gap == "next":
        after = np.clip(np.searchsorted(stamps, ticks, side="left"), 0, len(stamps) - 1)
        return np.ascontiguousarray(values[after]), missing
    filled = np.stack([np.interp(ticks - ticks[0], stamps - ticks[0], column) for column in values.T], axis=1)
    return filled, missing


def check_finite(what: str, values: Array) -> None:
    """Refuse (n, k) values that are not finite numbers; raises CaseError naming the first such sample."""
    bad = ~np.isfinite(values).all(axis=1)
    if bad.any():
        at = int(np.argmax(bad))
        raise CaseError(f"{what}: not a finite number in sample {at}", value=str(values[at]), remedy="drop this run")
