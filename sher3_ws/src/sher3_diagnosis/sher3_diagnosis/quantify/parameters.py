"""Parameters of a cause with their intervals.

An interval adds up from the jackknife over runs, what the robot's as-built deviations can move a coefficient by, how
coarsely a shape was searched, and the law being an idealisation. The last two dominate where noise averages out.
"""

from __future__ import annotations

import numpy as np

from sher3_diagnosis.channel import AT_TIP, Array
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fitting import Fit, Term
from sher3_diagnosis.thresholds import (
    AS_BUILT_SHARE,
    JACKKNIFE,
    LAW_UNCERTAINTY,
    MIN_RUNS,
    REACH_UNCERTAINTY,
    SHAPE_UNCERTAINTY,
)
from sher3_diagnosis.verdict import Parameter

UNSEEN_BY_REPEATS = (*AT_TIP, "sensing")
"""Stages at which a healthy robot deviates from its drawing by something that repeats and no repeat shows."""


def parameters(evidence: Evidence, fit: Fit, index: int) -> dict[str, Parameter]:
    """Return the parameters of one cause with 95 % intervals; without them where the runs are too few."""
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
        half = JACKKNIFE * jackknife + built + LAW_UNCERTAINTY * abs(x)
        if name in term.shape or term.width == 0:
            share = REACH_UNCERTAINTY if name == "displacement" else SHAPE_UNCERTAINTY
            half = max(half, share * abs(x))
        unit = term.effect.unit(name, term.site, term.site in evidence.rotary)
        bounded = runs >= MIN_RUNS and name not in term.effect.discrete
        out[name] = Parameter(value=x, low=x - half if bounded else None, high=x + half if bounded else None, unit=unit)
    return out


def _as_built_steps(term: Term) -> Array:
    """Change of each coefficient that a systematic residual of `AS_BUILT_SHARE` of the floor could cause at tip and
    sensor, (p,).
    """
    energy, count = np.zeros(term.width), np.zeros(term.width)
    for run in term.columns:
        for channel, x in run.items():
            if channel.stage in UNSEEN_BY_REPEATS:
                used = np.any(x != 0.0, axis=1)
                energy[: x.shape[1]] += np.sum(x**2, axis=0)
                count[: x.shape[1]] += used.sum()
    rms = np.sqrt(energy / np.maximum(count, 1.0))
    return np.where(rms > 0.0, AS_BUILT_SHARE / np.where(rms > 0.0, rms, 1.0), 0.0)
