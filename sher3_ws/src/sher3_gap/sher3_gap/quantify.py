"""How far the gap shrinks, and how sure its numbers are: closures and parameter intervals from resampled runs."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from sher3_gap.channels import Array, Channel, partly_free, restored
from sher3_gap.evidence import Evidence
from sher3_gap.fitting import Fit, Term
from sher3_gap.localise import PARTS
from sher3_gap.verdict import Interval, Parameter

RESAMPLES = 400
MIN_RUNS = 5
"""Fewer runs than this carry no interval."""
FLOOR_UNCERTAINTY = 0.05
"""Relative standard error of the floor's power with a handful of repeats."""
SHAPE_UNCERTAINTY = 0.25
"""Relative uncertainty of a nonlinear parameter: the step of its search and the meaning it has in another form of
the law.
"""
REACH_UNCERTAINTY = 0.4
"""The same of a displacement over which a force or a lag builds up: laws differ most in the form of that."""
AS_BUILT_SHARE = 0.5
"""Systematic residual of a healthy robot at tip and force sensor, over the floor."""
AS_BUILT_CLOSURE = 0.02
"""Closure that a healthy robot's own deviations may take or give."""
IDEALISED = 0.1
"""Share of the gap that an idealised law may leave of an effect it stands for, which would close that much more."""
LAW_UNCERTAINTY = 0.06
"""Relative uncertainty of a parameter that comes from the effect's law being an idealisation."""


def residual_after(evidence: Evidence, fit: Fit, channel: Channel) -> dict[int, Array]:
    """Residual of a channel with the fit's effects added, {run: (N_ok, d)} in SI units, with coefficients of the other
    runs.
    """
    out: dict[int, Array] = {}
    data = evidence.data
    for r, targets in enumerate(data.target):
        if channel not in targets:
            continue
        left, start = targets[channel].copy(), 0
        for term in fit.terms:
            if channel in term.fixed[r]:
                left -= term.fixed[r][channel]
            if channel in term.columns[r]:
                x = term.columns[r][channel]
                left -= x @ fit.loro_coefficients[r][start : start + x.shape[1]]
            start += term.width
        floor = evidence.floors[r][channel]
        out[r] = left.reshape(-1, len(floor)) * floor
    return out


def closure(evidence: Evidence, channel: Channel, before: Fit, after: Fit) -> Interval:
    """Closure kappa = (L0 - L1) / (L0 - F) of a channel on held-out runs, with a 95 % interval from resampling runs.

    At the tip the position counts, as the contract's closure does.
    """
    old, new = residual_after(evidence, before, channel), residual_after(evidence, after, channel)
    rows, repeats = [], zeros_floor(evidence, channel)
    for r in old:
        part = PARTS[len(evidence.floors[r][channel])][0]
        floor = evidence.floors[r][channel][part]
        left = (restored(channel, x[r])[:, part] for x in (old, new))
        base = max(1.0, repeats / float(np.mean(floor**2)))
        rows.append([np.mean((x / floor) ** 2) for x in left] + [base])
    return interval_of(np.array(rows))


def zeros_floor(evidence: Evidence, channel: Channel) -> float:
    """Half the mean square difference of repeats of a residual whose mean is partly free, the means included; else 0.

    What a lost motion rests at differs from run to run: no model of the command tells it.
    """
    if not partly_free(channel):
        return 0.0
    squares = []
    found = [(run.excitation, r.get(channel)) for run, r in zip(evidence.runs, evidence.data.residuals, strict=True)]
    for (name, x), (other, y) in combinations(found, 2):
        if name == other and x is not None and y is not None:
            n = min(len(x.values), len(y.values))
            ok = x.ok[:n] & y.ok[:n]
            if not ok.any():
                continue
            squares.append(0.5 * float(np.mean((x.values[:n] - y.values[:n])[ok] ** 2)))
    return float(np.mean(squares)) if squares else 0.0


def interval_of(rows: Array) -> Interval:
    """Closure from rows (runs, 3) of L0, L1, F per run."""
    value = _kappa(rows.mean(axis=0))
    if len(rows) < MIN_RUNS:
        return Interval(value=value)
    rng = np.random.default_rng(0)
    picks = rng.integers(0, len(rows), (RESAMPLES, len(rows)))
    floors = rng.normal(1.0, FLOOR_UNCERTAINTY, RESAMPLES)
    draws = np.array([_kappa(rows[p].mean(axis=0) * [1.0, 1.0, f]) for p, f in zip(picks, floors, strict=True)])
    low, high = np.percentile(draws, [2.5, 97.5])
    low, high = min(low, value - AS_BUILT_CLOSURE), max(high, value + IDEALISED)
    return Interval(value=value, low=float(low), high=float(min(1.0, high)))


def _kappa(row: Array) -> float:
    before, after, floor = row
    if before <= floor:
        return 0.0
    return float(np.clip((before - after) / (before - floor), -1.0, 1.0))


def parameters(evidence: Evidence, fit: Fit, index: int) -> dict[str, Parameter]:
    """Parameters of one cause with 95 % intervals.

    They add up from the jackknife over runs, what the robot's as-built deviations can move a coefficient by, how
    coarsely a shape was
    searched, and the law being an idealisation: the last two dominate where noise averages out.
    """
    term = fit.terms[index]
    best = fit.of(index)
    value = term.effect.parameters(term.shape, best)
    runs = len(fit.loro_coefficients)
    draws = [term.effect.parameters(term.shape, c) for c in fit.loro_of(index)]
    moved = [term.effect.parameters(term.shape, best + step) for step in np.diag(_as_built_steps(term))]
    out: dict[str, Parameter] = {}
    for name, x in value.items():
        spread = np.array([d[name] for d in draws])
        jackknife = float(np.sqrt((runs - 1) / runs * np.sum((spread - spread.mean()) ** 2)))
        built = float(np.sqrt(sum((m[name] - x) ** 2 for m in moved)))
        half = 2.3 * jackknife + built + LAW_UNCERTAINTY * abs(x)
        if name in term.shape or term.width == 0:
            share = REACH_UNCERTAINTY if name == "displacement" else SHAPE_UNCERTAINTY
            half = max(half, share * abs(x))
        unit = term.effect.unit(name, term.site)
        bounded = runs >= MIN_RUNS
        out[name] = Parameter(value=x, low=x - half if bounded else None, high=x + half if bounded else None, unit=unit)
    return out


def _as_built_steps(term: Term) -> Array:
    """Change of each coefficient that a systematic residual of `AS_BUILT_SHARE` of the floor could cause at tip and
    sensor, (p,).
    """
    energy, count = np.zeros(term.width), np.zeros(term.width)
    for run in term.columns:
        for channel, x in run.items():
            if channel.stage in ("mechanism", "structure", "sensing"):
                used = np.any(x != 0.0, axis=1)
                energy[: x.shape[1]] += np.sum(x**2, axis=0)
                count[: x.shape[1]] += used.sum()
    rms = np.sqrt(energy / np.maximum(count, 1.0))
    return np.where(rms > 0.0, AS_BUILT_SHARE / np.where(rms > 0.0, rms, 1.0), 0.0)


def excess(evidence: Evidence, channel: Channel, fit: Fit | None = None) -> float:
    """Loss above the floor of a channel under a fit; without one, of the nominal model."""
    loss = evidence.data.null_loss if fit is None else fit.loss
    return sum(v for (_, c), v in loss.items() if c == channel) - samples_of(evidence, channel)


def samples_of(evidence: Evidence, channel: Channel) -> int:
    """Whitened samples of a channel over all runs: its loss at the floor."""
    return sum(n for (_, c), n in evidence.data.samples.items() if c == channel)
