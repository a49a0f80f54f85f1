"""Shapes polished beyond the grid of their search, by steps of Gauss and Newton that lower the held-out loss."""

from __future__ import annotations

from dataclasses import replace

from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, fit
from sher3_diagnosis.fit.term import make_term
from sher3_diagnosis.quantify.local import local

STEPS = 4
"""Steps at most: each is quadratic, and the grid is a few percent away."""
LONGEST = 0.05
"""Relative change of a shape parameter in one step."""


def polished(evidence: Evidence, attribution: Attribution) -> Attribution:
    """Return an attribution whose causes have the best shapes near those found."""
    current = attribution.fit
    for i in attribution.causes:
        current = _polish(evidence, current, i)
    return replace(attribution, fit=current)


def _polish(evidence: Evidence, current: Fit, index: int) -> Fit:
    for _ in range(STEPS):
        term = current.terms[index]
        change = local(evidence, current, index).step
        shape = dict(term.shape)
        for name, by in change.items():
            room = LONGEST * abs(shape[name])
            shape[name] += min(max(by, -room), room)
        if shape == term.shape:
            return current
        terms = list(current.terms)
        terms[index] = make_term(evidence.data, term.effect, term.site, shape)
        trial = fit(evidence.data, terms)
        if not trial.admissible or trial.total >= current.total:
            return current
        current = trial
    return current
