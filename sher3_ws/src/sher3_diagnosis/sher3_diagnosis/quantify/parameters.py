"""Parameters of a cause with their intervals, measured from how its fit scatters over pieces of the data.

Noise and deviations of the machine within tolerance move a parameter by what their size says. Where noise averages out,
what is left is the law being an idealisation: it wants another size in each piece, and it leaves a share of its gap. A
law that is right leaves nothing, and its parameter is narrow.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sher3_diagnosis.attribute.local import Local, local
from sher3_diagnosis.attribute.rivals import without_term
from sher3_diagnosis.channel import Array
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit
from sher3_diagnosis.fit.term import Term
from sher3_diagnosis.localise.gaps import gap_of
from sher3_diagnosis.quantify.closure import residual_after
from sher3_diagnosis.quantify.remains import excess_of, remains
from sher3_diagnosis.thresholds import BEYOND, HIDDEN, JACKKNIFE, MIN_RUNS, MISFIT, NORMAL
from sher3_diagnosis.verdict import Parameter

STEP = 1e-4
"""Relative step of the derivative of a parameter with respect to what was fitted."""


def parameters(evidence: Evidence, fit: Fit, index: int) -> dict[str, Parameter]:
    """Return the parameters of one cause with 95 % intervals.

    Without an interval where the runs are too few, and where the parameter is a choice or was searched on a grid alone.
    """
    term, best = fit.terms[index], fit.of(index)
    bounded = len(fit.loro_coefficients) >= MIN_RUNS
    around = local(evidence, fit, index) if bounded else None
    misfit = hidden_share(evidence, fit, index)
    measured = term.effect.measured(evidence.views, term.site, term.shape)
    out: dict[str, Parameter] = {}
    for name, x in term.effect.parameters(term.shape, best).items():
        half = None if around is None or name in term.effect.discrete else _half_width(term, best, around, name, misfit)
        if name in measured and bounded:
            x, half = measured[name].value, max(half or 0.0, JACKKNIFE * measured[name].error)
        unit = term.effect.unit(name, term.site, term.site in evidence.rotary)
        low, high = (None, None) if half is None else (x - half, x + half)
        means = term.effect.choices.get(name, {}).get(x)
        out[name] = Parameter(value=x, low=low, high=high, unit=unit, means=means)
    return out


def least_widths(evidence: Evidence, fit: Fit, index: int) -> dict[str, float]:
    """Return the half widths that noise and deviations within tolerance alone leave the parameters of one cause.

    The bound of Cramer and Rao for a machine whose law is the page's: what the data tell, were the law exact.
    """
    term, best = fit.terms[index], fit.of(index)
    around = local(evidence, fit, index)
    gradients = {n: _gradient(term, best, around.names, n) for n in term.effect.parameters(term.shape, best)}
    return {name: NORMAL * around.noise(g) for name, g in gradients.items() if g.any()}


def hidden_share(evidence: Evidence, fit: Fit, index: int) -> float:
    """Return the relative error of a cause's parameters that the residual of its law allows."""
    without = without_term(evidence, fit, index)  # what it leaves below the floor shows nowhere
    gaps = (gap_of(evidence, c, residual_after(evidence, without, c)) for c in fit.terms[index].channels)
    ratio = max((g.ratio for g in gaps if g is not None), default=1.0)
    return float(np.hypot(MISFIT * left_share(evidence, fit, index) ** 0.5, HIDDEN / max(ratio, 1.0)))


def left_share(evidence: Evidence, fit: Fit, index: int) -> float:
    """Return the share of its gap, above the floor and on held-out runs, that a cause leaves: 0 to 1."""
    without = without_term(evidence, fit, index)
    channels = fit.terms[index].channels
    gap = sum(max(evidence.excess(c, without), 0.0) for c in channels)
    left = sum(max(excess_of(evidence, c, remains(evidence, fit, index, c)), 0.0) for c in channels)
    return min(1.0, left / gap) if gap > 0.0 else 1.0


def _half_width(term: Term, best: Array, around: Local, name: str, misfit: float) -> float | None:
    """Half width of a parameter's interval; None where nothing that was fitted moves it.

    `misfit` is the relative error that what the law leaves may hide in its parameters.
    """
    gradient = _gradient(term, best, around.names, name)
    if not gradient.any():
        return None
    value = term.effect.parameters(term.shape, best)[name]
    return float(np.hypot(NORMAL * around.noise(gradient), BEYOND * np.hypot(around.scatter(gradient), misfit * value)))


def _gradient(term: Term, best: Array, names: tuple[str, ...], name: str) -> Array:
    """Derivative of a parameter with respect to the coefficients and the shape parameters `names`."""
    size = float(np.abs(best).max()) if len(best) else 0.0

    def at(shape: Mapping[str, float], coefficients: Array) -> float:
        return term.effect.parameters(shape, coefficients)[name]

    out = []
    for k in range(len(best)):
        step = np.zeros(len(best))
        step[k] = STEP * max(abs(best[k]), 1e-3 * size, 1e-300)
        out.append((at(term.shape, best + step) - at(term.shape, best - step)) / (2.0 * step[k]))
    for n in names:
        by = STEP * term.shape[n]
        ends = (at({**term.shape, n: term.shape[n] + s}, best) for s in (by, -by))
        high, low = ends
        out.append((high - low) / (2.0 * by))
    return np.array(out)
