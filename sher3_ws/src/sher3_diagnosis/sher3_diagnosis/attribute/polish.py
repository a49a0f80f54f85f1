"""Shapes polished beyond the grid of their search, by steps of Gauss and Newton that lower the held-out loss."""

from __future__ import annotations

from dataclasses import replace

from sher3_diagnosis.attribute.local import local
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, fit
from sher3_diagnosis.fit.term import make_term

STEPS = 8
"""Steps at most: each is quadratic, but some grids are a factor of four apart."""
LONGEST = 0.25
"""Relative change of a shape parameter in one step."""
SHORTER = (1.0, 0.3)
"""Shares of a step that are tried: the whole one may overshoot where the grid is coarse."""
WORTH = 0.01
"""Loss that a step must lower for another one to follow."""


def polished(evidence: Evidence, attribution: Attribution) -> Attribution:
    """Return an attribution whose causes have the best shapes near those found."""
    current = attribution.fit
    for i in attribution.causes:
        current = polish(evidence, current, i)
    return replace(attribution, fit=current)


def polish(evidence: Evidence, current: Fit, index: int) -> Fit:
    """Return a fit with the best shape of one term near that found."""
    for _ in range(STEPS):
        change = local(evidence, current, index).step
        trials = (_stepped(evidence, current, index, change, share) for share in SHORTER)
        better = next((t for t in trials if t is not None and t.total < current.total), None)
        if better is None:
            return current
        gained, current = current.total - better.total, better
        if gained < WORTH:
            return current
    return current


def _stepped(evidence: Evidence, current: Fit, index: int, change: dict[str, float], share: float) -> Fit | None:
    """Return the fit with one term's shape changed by a share of a step; None where nothing changes or may be."""
    term = current.terms[index]
    shape = dict(term.shape)
    for name, by in change.items():
        room = LONGEST * abs(shape[name])
        shape[name] += share * min(max(by, -room), room)
    if shape == term.shape or not term.effect.allowed(evidence.views, term.site, shape):
        return None
    terms = list(current.terms)
    terms[index] = make_term(evidence.data, term.effect, term.site, shape)
    trial = fit(evidence.data, terms)
    return trial if trial.admissible else None
