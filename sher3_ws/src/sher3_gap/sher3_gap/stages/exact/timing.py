"""How commands reach the drives, from their echo: a constant latency, jitter, drops, one axis late.

The stage is exact, so the latency is read off tick by tick instead of being fitted to noise. Energies are sums of
squares of the echo's error with every axis scaled by its velocity limit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_description import Robot
from sher3_diagnosis.channel import Array, Mask

from sher3_gap.signals import RunSignals
from sher3_gap.stages.exact.law import delayed, shifted
from sher3_gap.stages.residuals import Demand

MAX_TICKS = 30
"""Longest latency that is looked for, in periods."""
TELLING_STEP = 1e-3
"""Change of the command, as a share of the velocity limit, from which a tick tells its latency."""
CYCLES = range(2, 11)
"""Ticks after which a drive may look for a demand again."""
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
        energy: of the nominal echo error; `constant`: with a constant latency of each axis; `per_tick`: with one of
            every tick.
        latency: (axes,) constant latency in periods, of the ticks that were not held.
        samples: per-tick latencies shared by the axes, periods (telling ticks only).
        drops: share of telling ticks whose command was held one period or more too long.
        scatter: standard deviation of the latencies that are not drops, periods.
        alone: index of the axis whose commands alone come late, of which the ticks then tell; None where several do.
        apart: share of the error of ticks not held that a latency of each axis explains beyond one for all.
        clockwork: share of the late ticks that are as late as another one a few ticks before, always as many.
    """

    energy: float
    constant: float
    per_tick: float
    latency: Array
    samples: Array
    drops: float
    scatter: float
    alone: int | None = None
    apart: float = 0.0
    clockwork: float = 0.0


Pair = tuple[Array, Array, Mask]
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
    moves = np.sum((delayed(command, 1 + base) - delayed(command, 2 + base)) ** 2, axis=1) > TELLING_STEP**2
    usual = left < UNEXPLAINED
    ticks[moves & usual] = np.median(around)
    for whole in sorted(range(max(0, base - 3), base + HELD), key=lambda n: abs(n - base)):
        new, old = delayed(command, 1 + whole), delayed(command, 2 + whole)
        step = new - old
        energy = np.sum(step**2, axis=1)
        part = np.clip(np.sum(step * (new - echo), axis=1) / np.where(energy > 0, energy, 1.0), 0.0, 1.0)
        trial = echo - (new - part[:, None] * step)
        square = np.sum(trial**2, axis=1)
        tells = energy > TELLING_STEP**2
        better = square <= left if whole == base else tells & (square < 0.01 * left) & (left > UNEXPLAINED)
        timed = better & tells & ~usual
        ticks[timed] = (whole + part)[timed]
        left[better], error[better] = square[better], trial[better]
    return ticks, error


def timing_of(runs: Sequence[RunSignals], robot: Robot) -> Timing | None:
    """Read the timing of a case; None when no run has both command and echo."""
    pairs = [scaled(run, robot) for run in runs if run.command is not None and run.echo is not None]
    if not pairs:
        return None
    each = np.sum([np.sum((e - delayed(c, 1))[ok] ** 2, axis=0) for c, e, ok in pairs], axis=0)
    odd = np.flatnonzero(each > QUIET)
    alone = int(odd[0]) if len(odd) == 1 else None
    axes, ticks, left = read_off(pairs, pairs, alone)
    constant, kept = sum(a[1] for a in axes), pairs
    usual = usual_of(ticks)
    held = [t > usual + WHOLE for t in ticks]
    if any(h.any() for h in held):  # what is held now and then belongs to no axis' latency
        kept = [(c, e, ok & ~h) for (c, e, ok), h in zip(pairs, held, strict=True)]
        axes, ticks, left = read_off(pairs, kept, alone)
    rest = sum(float(np.sum((e - delayed(c, 1))[ok] ** 2)) for c, e, ok in kept)
    samples = telling(ticks)
    dropped = samples > usual_of(ticks) + WHOLE
    return Timing(
        energy=float(each.sum()),
        constant=constant,
        per_tick=left,
        latency=np.array([a[0] for a in axes]),
        samples=samples,
        drops=float(dropped.mean()) if len(samples) else 0.0,
        scatter=float(np.std(samples[~dropped])) if not dropped.all() else 0.0,
        alone=alone,
        apart=(constant_latency(kept)[1] - sum(a[1] for a in axes)) / rest if rest > QUIET else 0.0,
        clockwork=clockwork(ticks),
    )


def read_off(
    pairs: Sequence[Pair], kept: Sequence[Pair], alone: int | None
) -> tuple[list[tuple[float, float]], list[Array], float]:
    """Return latency and energy left of every axis over the ticks kept, latencies of all ticks, and energy these leave.

    The latencies of ticks are arrays (n,), in periods, NaN where none is told; of one axis where it alone is late.
    """
    axes = [constant_latency(kept, i) for i in range(pairs[0][0].shape[1])]
    latency = np.array([a[0] for a in axes])
    judged = slice(None) if alone is None else slice(alone, alone + 1)
    ticks, left = [], 0.0
    for command, echo, ok in pairs:
        found, error = tick_latency(command[:, judged], echo[:, judged], latency[judged])
        ticks.append(np.where(ok, found, np.nan))
        left += float(np.sum(error[ok] ** 2))
    return axes, ticks, left


def telling(ticks: Sequence[Array]) -> Array:
    """Return the latencies of the ticks that tell one, (N,), periods."""
    return np.concatenate([t[np.isfinite(t)] for t in ticks])


def usual_of(ticks: Sequence[Array]) -> float:
    """Return the median latency, periods, of the ticks (n,) of all runs that tell one; 0 where none does."""
    every = telling(ticks)
    return float(np.median(every)) if len(every) else 0.0


def clockwork(ticks: Sequence[Array]) -> float:
    """Return the share of late ones among ticks (n,), by a period or more, that are as late as one of the cycle before.

    Of all lengths of a cycle in `CYCLES` the largest share. A share of 1 is a drive that looks for a demand at every
    second, third... tick; commands that are lost by chance, each with p, have p at most.
    """
    best = 0.0
    whole = [np.rint(t - np.nanmin(t)) if np.isfinite(t).any() else t for t in ticks]
    for cycle in CYCLES:
        odd = [(t[cycle:] >= 1.0) & np.isfinite(t[:-cycle]) for t in whole]
        same = sum(int(np.sum(o & (t[cycle:] == t[:-cycle]))) for t, o in zip(whole, odd, strict=True))
        best = max(best, same / max(1, sum(int(o.sum()) for o in odd)))
    return best


def demand_in_force(run: RunSignals, robot: Robot, timing: Timing | None) -> Demand | None:
    """Demand in force at the drives just before each tick, from the echo; None where commands arrive on time."""
    if timing is None or run.command is None or run.echo is None or timing.energy < QUIET:
        return None
    whole = np.floor(timing.latency + 1e-6).astype(int)
    newest = np.column_stack([delayed(run.command[:, [i]], 1 + n)[:, 0] for i, n in enumerate(whole)])
    older = np.column_stack([delayed(run.command[:, [i]], 2 + n)[:, 0] for i, n in enumerate(whole)])
    step = newest - older
    large = np.abs(step) > TELLING_STEP * np.array([a.limits.velocity for a in robot.actuators])
    part = np.where(large, (newest - run.echo) / np.where(large, step, 1.0), timing.latency - whole)
    between = np.abs(run.echo - newest) <= np.abs(step) * (1.0 - 1e-6) + 1e-12
    return Demand(np.where(between, newest, run.echo), np.clip(part, 0.0, 1.0))
