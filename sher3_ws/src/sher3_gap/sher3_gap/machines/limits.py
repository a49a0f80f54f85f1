"""A drive at its limit: the command lies flat at its largest value while the axis does not get where it is sent.

Read off the command itself, as the engine reads timing off the echo: a level at which a record stays is no matter of
fitting. The need is the commanded law's, where its gains are known, else what holds the nominal weight on the way to
the goal.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from sher3_gap.channels import Array
from sher3_gap.machines.axis_view import signals_of
from sher3_gap.machines.description import Axis
from sher3_gap.machines.intake import AxesRun
from sher3_gap.quantify import MIN_RUNS, interval_of
from sher3_gap.verdict import Cause, Interval, Parameter, Residual, Where

FLAT = 1e-3
"""Commands within this share of the largest count as at the limit."""
PINNED = 0.02
"""Share of a record at the limit from which it is named; a free command touches its largest value for a moment."""
LONGEST = 10
"""Samples in a row it must stay there."""
BLOCKS = 8


@dataclass(frozen=True)
class LimitFinding:
    """A drive at its limit."""

    where: Where
    cause: Cause
    residual: Residual


def limit_finding(runs: Sequence[AxesRun], axis: Axis, without: Collection[str]) -> LimitFinding | None:
    """Find a limit that keeps an axis from its goal; None when there is none, or no command was recorded."""
    if "force_saturation" in without or axis.signals.command is None or axis.command_law.kind != "force":
        return None
    rows, levels, gaps, floors, share = [], [], [], [], []
    for run in runs:
        signals = run.signals[axis.name]
        command = axis.command_law.gain * signals["command"]
        level = float(np.abs(command).max())
        flat = np.abs(command) >= (1.0 - FLAT) * level
        need = _need(run, axis)
        pinned = flat & (need * np.sign(command) > (1.0 + FLAT) * level)
        if level == 0.0 or pinned.mean() < PINNED or _longest(pinned) < LONGEST:
            continue
        given = signals.get("effort", command)
        floor = max(float(np.std(given[flat] - command[flat])), axis.effort_resolution / np.sqrt(12.0), FLAT * level)
        for part in np.array_split(np.flatnonzero(pinned), BLOCKS):
            old, new = need[part] - given[part], command[part] - given[part]
            rows.append([float(np.mean((x / floor) ** 2)) for x in (old, new)] + [1.0])
        levels.append(float(np.median(np.abs(given[pinned]))))
        gaps.append(float(np.sqrt(np.mean((need - given)[pinned] ** 2))))
        floors.append(floor)
        share.append(float(pinned.mean()))
    if not rows:
        return None
    return _finding(axis, np.array(rows), levels, float(np.mean(gaps)), float(np.mean(floors)), float(np.mean(share)))


def _finding(axis: Axis, rows: Array, levels: list[float], gap: float, floor: float, share: float) -> LimitFinding:
    unit = "N" if axis.motion == "linear" else "N*m"
    level = float(np.median(levels))
    half = max(2.0 * floor, 0.06 * level)
    bounded = len(rows) >= MIN_RUNS
    limit = Parameter(
        value=level, low=level - half if bounded else None, high=level + half if bounded else None, unit=unit
    )
    kappa: Interval = interval_of(rows)
    cause = Cause(
        effect="force_saturation",
        family="limit",
        stage="drive",
        actuator=axis.name,
        parameters={"limit": limit},
        closure=kappa,
    )
    left = floor * float(np.sqrt(rows[:, 1].mean()))
    where = Where(
        stage="drive",
        actuator=axis.name,
        gap=gap,
        floor=floor,
        unit=unit,
        regime=f"{share:.0%} of the time at the limit",
        confidence=float(1.0 - np.exp(-gap / floor)),
    )
    return LimitFinding(where, cause, Residual(gap=left, floor=floor, unit=unit))


def _need(run: AxesRun, axis: Axis) -> Array:
    """Force the nominal machine asks for at each sample, (n,), without a limit."""
    signals, law, g = run.signals[axis.name], axis.command_law, axis.gravity
    q = signals["position"]
    goal = signals.get("reference")
    if law.goal is not None:
        goal = np.full_like(q, law.goal)
    if goal is None:
        return np.zeros_like(q)
    if law.position_gain is not None:
        velocity = signals_of(run, axis, run.name).velocity[:, 0]
        return np.asarray(law.gain * (law.position_gain * (goal - q) - law.velocity_gain * velocity))
    way = np.linspace(0.0, 1.0, 50)[:, None] * (goal - q) + q
    weight = g.constant + g.arm * np.sin(way - g.hanging)
    return np.asarray(np.take_along_axis(weight, np.abs(weight).argmax(axis=0)[None], 0)[0])


def _longest(mask: np.ndarray) -> int:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(int), [0]])))
    return int((edges[1::2] - edges[::2]).max()) if len(edges) else 0
