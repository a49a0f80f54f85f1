"""What the echo of the drives tells about the way of the commands: a constant latency, jitter, drops, one axis late.

The stage is exact, so the latency is read off tick by tick instead of being fitted to noise. Energies are sums of
squares of the echo's error with every axis scaled by its velocity limit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sher3_description import Robot
from sher3_diagnosis.channel import Array

from sher3_gap.signals import RunSignals
from sher3_gap.stages.exact.law import delayed, shifted
from sher3_gap.stages.residuals import Demand

MAX_TICKS = 30
"""Longest latency that is looked for, in periods."""
TELLING_STEP = 1e-3
"""Change of the command, as a share of the velocity limit, from which a tick tells its latency."""
QUIET = 1e-12
"""Energy of the scaled echo error below which commands arrive on time."""
HELD = 20
"""Longest hold that is looked for, in periods beyond the usual latency: drops come in bursts."""
WHOLE = 0.75
"""Lateness beyond the median, in periods, from which a tick's command was held for a whole period."""
UNEXPLAINED = 1e-10
"""Square of the scaled echo error from which another whole number of periods is tried for a tick."""


@dataclass(frozen=True)
class Timing:
    """How commands reach the drives in one case.

    Attributes:
        energy: of the nominal echo error; `shared`: with one latency for all axes; `constant`: with each axis' own;
        `per_tick`: with every tick's own.
        latency: (axes,) constant latency in periods.
        common: latency shared by all axes, periods.
        samples: per-tick latencies shared by the axes, periods (telling ticks only).
        drops: share of telling ticks whose command was held one period or more too long.
        scatter: standard deviation of the latencies that are not drops, periods.
        alone: index of the axis whose commands alone come late, of which the ticks then tell; None where several do.
    """

    energy: float
    shared: float
    constant: float
    per_tick: float
    latency: Array
    common: float
    samples: Array
    drops: float
    scatter: float
    alone: int | None = None


Pair = tuple[Array, Array, NDArray[np.bool_]]
"""Command and echo over the velocity limits, (n, axes) each, and the ticks whose echo tells, (n,)."""


def scaled(run: RunSignals, robot: Robot) -> Pair:
    """Return command and echo of a run."""
    assert run.command is not None and run.echo is not None
    top = np.array([a.limits.velocity for a in robot.actuators])
    return run.command / top, run.echo / top, run.echo_tells


def constant_latency(pairs: Sequence[Pair], axis: int | None = None) -> tuple[float, float]:
    """Best constant latency (periods) and the energy it leaves; of one axis, or of all together."""
    best = (0.0, np.inf)
    pick = slice(None) if axis is None else slice(axis, axis + 1)
    for whole in range(MAX_TICKS):
        slope = bend = 0.0
        for command, echo, ok in pairs:
            new, old = delayed(command[:, pick], 1 + whole)[ok], delayed(command[:, pick], 2 + whole)[ok]
            slope += float(np.sum((new - old) * (new - echo[ok][:, pick])))
            bend += float(np.sum((new - old) ** 2))
        part = float(np.clip(slope / bend, 0.0, 1.0)) if bend > 0.0 else 0.0
        left = sum(float(np.sum((e[:, pick] - shifted(c[:, pick], whole + part))[ok] ** 2)) for c, e, ok in pairs)
        if left < best[1] - 1e-18:
            best = (whole + part, left)
        elif whole > best[0] + 3:
            break
    return best


def tick_latency(command: Array, echo: Array, around: Array) -> tuple[Array, Array]:
    """Latency of every tick shared by the axes, (n,) periods (NaN where no step tells), and the echo error left,
    (n, axes).

    `around` (axes,) are the constant latencies; a tick's own deviation from them is common to all axes.
    """
    ticks = np.full(len(echo), np.nan)
    error = echo - np.column_stack([shifted(command[:, [i]], a)[:, 0] for i, a in enumerate(around)])
    left = np.sum(error**2, axis=1)
    base = int(np.floor(np.median(around) + 1e-6))
    for whole in sorted(range(max(0, base - 3), base + HELD), key=lambda n: abs(n - base)):
        new, old = delayed(command, 1 + whole), delayed(command, 2 + whole)
        step = new - old
        energy = np.sum(step**2, axis=1)
        part = np.clip(np.sum(step * (new - echo), axis=1) / np.where(energy > 0, energy, 1.0), 0.0, 1.0)
        trial = echo - (new - part[:, None] * step)
        square = np.sum(trial**2, axis=1)
        tells = energy > TELLING_STEP**2
        better = square <= left if whole == base else tells & (square < 0.01 * left) & (left > UNEXPLAINED)
        ticks[better & tells], left[better] = (whole + part)[better & tells], square[better]
        error[better] = trial[better]
    return ticks, error


def timing_of(runs: Sequence[RunSignals], robot: Robot) -> Timing | None:
    """Read the timing of a case; None when no run has both command and echo."""
    pairs = [scaled(run, robot) for run in runs if run.command is not None and run.echo is not None]
    if not pairs:
        return None
    each = np.sum([np.sum((e - delayed(c, 1))[ok] ** 2, axis=0) for c, e, ok in pairs], axis=0)
    axes = [constant_latency(pairs, i) for i in range(pairs[0][0].shape[1])]
    latency = np.array([a[0] for a in axes])
    common, together = constant_latency(pairs)
    odd = np.flatnonzero(each > QUIET)
    alone = int(odd[0]) if len(odd) == 1 else None
    judged = slice(None) if alone is None else slice(alone, alone + 1)
    told, left = [], 0.0
    for command, echo, ok in pairs:
        ticks, error = tick_latency(command[:, judged], echo[:, judged], latency[judged])
        told.append(ticks[np.isfinite(ticks) & ok])
        left += float(np.sum(error[ok] ** 2))
    samples = np.concatenate(told)
    middle = float(np.median(samples)) if len(samples) else common
    late = samples > middle + WHOLE
    rest = samples[~late]
    scatter = float(np.std(rest)) if len(rest) else 0.0
    return Timing(
        float(each.sum()),
        together,
        sum(a[1] for a in axes),
        left,
        latency,
        common,
        samples,
        float(late.mean()) if len(samples) else 0.0,
        scatter,
        alone,
    )


def demand_in_force(run: RunSignals, robot: Robot, timing: Timing | None) -> Demand | None:
    """What the drives held just before each tick, told from the echo; None where commands arrive on time."""
    if timing is None or run.command is None or run.echo is None or timing.energy < QUIET:
        return None
    whole = np.floor(timing.latency + 1e-6).astype(int)
    newest = np.column_stack([delayed(run.command[:, [i]], 1 + n)[:, 0] for i, n in enumerate(whole)])
    older = np.column_stack([delayed(run.command[:, [i]], 2 + n)[:, 0] for i, n in enumerate(whole)])
    step = newest - older
    told = np.abs(step) > TELLING_STEP * np.array([a.limits.velocity for a in robot.actuators])
    part = np.where(told, (newest - run.echo) / np.where(told, step, 1.0), timing.latency - whole)
    between = np.abs(run.echo - newest) <= np.abs(step) * (1.0 - 1e-6) + 1e-12
    return Demand(np.where(between, newest, run.echo), np.clip(part, 0.0, 1.0))
