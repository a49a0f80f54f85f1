"""How far the gap shrinks, and how sure its numbers are: closures and parameter intervals from resampled runs."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit
from sher3_diagnosis.localise.gaps import PARTS
from sher3_diagnosis.thresholds import MIN_RUNS, PIECES, SHOWN
from sher3_diagnosis.verdict import Interval

RESAMPLES = 400
"""Resamples of the runs from which an interval is read."""


def residual_after(evidence: Evidence, fit: Fit, channel: Channel) -> dict[int, Array]:
    """Residual of a channel with the fit's effects added, {run: (N_ok, d)} in SI units, with coefficients of the other
    runs.
    """
    out: dict[int, Array] = {}
    own = [(term, fit.loro_of(i)) for i, term in enumerate(fit.terms) if channel in term.channels]
    for r, targets in enumerate(evidence.data.target):
        if channel not in targets:
            continue
        left = targets[channel].copy()
        for term, coefficients in own:
            left -= term.adds(r, channel, coefficients[r])
        floor = evidence.floors[r][channel]
        out[r] = left.reshape(-1, len(floor)) * floor
    return out


def closure(evidence: Evidence, channel: Channel, before: Fit, after: Fit) -> Interval:
    """Closure kappa = (L0 - L1) / (L0 - F) of a channel on held-out runs, with a 95 % interval from resampling runs.

    At the tip the position counts, as the contract's closure does.
    """
    found = interval_of(_rows(evidence, channel, before, after))
    return up_to_whole(found) if len(after.terms) > len(before.terms) else found


def up_to_whole(found: Interval) -> Interval:
    """Return the closure that the causes' own laws may have, of which those of the pages are idealisations.

    What the pages leave the causes' own laws close: on labelled cases the closure of the true law lay higher by just
    the share left, and a free function of the law's inputs found only a part of that. So nothing measured says that a
    cause closes less than all, and the interval is bounded below alone.
    """
    return found if found.high is None else found.model_copy(update={"high": 1.0})


def _rows(evidence: Evidence, channel: Channel, before: Fit, after: Fit) -> Array:
    """Return (pieces, 3) loss before and after and floor of every run, or piece of a run, that shows a channel."""
    old, new = (residual_after(evidence, f, channel) for f in (before, after))
    repeats = zeros_floor(evidence, channel)
    cuts = 1 if len(old) >= MIN_RUNS else PIECES  # where few runs show the channel, their pieces are resampled
    rows = []
    for r in old:
        part = PARTS[len(evidence.floors[r][channel])][0]
        floor = evidence.floors[r][channel][part]
        residual = evidence.data.residuals[r][channel]
        left = [residual.restored(x[r])[:, part] / floor for x in (old, new)]
        base = max(1.0, repeats / float(np.mean(floor**2)))
        pieces = zip(*(np.array_split(x, cuts) for x in left), strict=True)
        rows += [[np.mean(x**2) for x in piece] + [base] for piece in pieces if len(piece[0])]
    return np.array(rows)


def zeros_floor(evidence: Evidence, channel: Channel) -> float:
    """Half the mean square difference of repeats of a residual whose mean is partly free, the means included; else 0.

    What a lost motion rests at differs from run to run: no model of the command tells it.
    """
    squares = []
    found = [(e, r.get(channel)) for e, r in zip(evidence.excitations, evidence.data.residuals, strict=True)]
    for (name, x), (other, y) in combinations(found, 2):
        if name == other and x is not None and y is not None and x.partly_free:
            n = min(len(x.values), len(y.values))
            ok = x.ok[:n] & y.ok[:n]
            if not ok.any():
                continue
            squares.append(0.5 * float(np.mean((x.values[:n] - y.values[:n])[ok] ** 2)))
    return float(np.mean(squares)) if squares else 0.0


def interval_of(rows: Array) -> Interval:
    """Closure from rows (runs, 3) of L0, L1, F per run.

    The interval is that of resampled runs. Its lower end is at most the closure without any floor, 1 - L1 / L0: repeats
    say how much of what is left is floor, and a machine as built differs from its model by more.
    """
    row = rows.mean(axis=0)
    value = float(_kappa(row))
    if len(rows) < MIN_RUNS:
        return Interval(value=value)
    rng = np.random.default_rng(0)
    picks = rng.integers(0, len(rows), (RESAMPLES, len(rows)))
    resampled = rows[picks].mean(axis=1)
    draws = _kappa(resampled[_gap(resampled) >= SHOWN * _gap(row)])
    if len(draws) < RESAMPLES // 4:
        return Interval(value=value)
    low, high = np.percentile(draws, [2.5, 97.5])
    return Interval(value=value, low=float(min(low, 1.0 - row[1] / row[0], value)), high=float(max(high, value)))


def _gap(rows: Array) -> Array:
    """Return L0 - F of rows (..., 3)."""
    return np.asarray(rows[..., 0] - rows[..., 2])


def _kappa(rows: Array) -> Array:
    """Return the closure of rows (..., 3); zero where there is no gap above the floor."""
    gap = _gap(rows)
    share = np.divide(rows[..., 0] - rows[..., 1], gap, out=np.zeros_like(gap), where=gap > 0.0)
    return np.clip(share, -1.0, 1.0)
