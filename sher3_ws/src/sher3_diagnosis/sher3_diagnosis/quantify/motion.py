"""A fit on the samples in motion: a dry friction at rest takes any force up to its level and does not show it.

What the law predicts there is its level or less, by a history that nobody recorded. Fitted along, such samples pull the
level of a friction down, and its fall with the speed with it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sher3_diagnosis.attribute.polish import polish
from sher3_diagnosis.attribute.rivals import InMotion
from sher3_diagnosis.channel import Channel, Mask
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, fit
from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.fit.term import Term, make_term

LEAST = 0.3
"""Share of a channel's samples that must be in motion for them to tell its laws alone."""

Rests = dict[tuple[int, Channel], Mask]
"""Per run and channel, the samples that count at which a friction rests, (N,)."""


def in_motion(evidence: Evidence, found: Fit) -> InMotion | None:
    """Return a fit on the samples in motion; None where no cause is a friction that rests, or too little moves."""
    resting = [i for i in range(len(evidence.nuisance), len(found.terms)) if found.terms[i].effect.settles]
    rests: Rests = {}
    for i in resting:
        rests |= rests_of(evidence, found, i)
    if not rests or min(_moving(rests, c) for c in {c for _, c in rests}) < LEAST:
        return None
    moving = without(evidence, rests)
    terms = [_sliced(t, rests) for t in found.terms]
    current = fit(moving.data, terms)
    for i in resting:
        current = polish(moving, current, i)
    if not current.admissible:
        return None
    whole = [
        t if now.shape == t.shape else make_term(evidence.data, t.effect, t.site, now.shape)
        for t, now in zip(found.terms, current.terms, strict=True)
    ]
    coefficients, held_out = current.coefficients, current.loro_coefficients
    everywhere = replace(found, terms=tuple(whole), coefficients=coefficients, loro_coefficients=held_out)
    return InMotion(moving, current, everywhere)


def rests_of(evidence: Evidence, found: Fit, index: int) -> Rests:
    """Return where a cause may take any force up to its level; empty where it may nowhere."""
    term, out = found.terms[index], {}
    for r, view in enumerate(evidence.views):
        level = term.effect.held(view, term.site, term.shape, found.of(index))
        if level is None:
            return {}
        for c in term.columns[r]:
            if len(evidence.floors[r][c]) == 1:
                out[r, c] = level[evidence.data.residuals[r][c].ok] > 0.0
    return out if any(x.any() for x in out.values()) else {}


def _moving(rests: Rests, channel: Channel) -> float:
    """Share of a channel's samples at which nothing rests."""
    return 1.0 - float(np.concatenate([x for (_, c), x in rests.items() if c == channel]).mean())


def without(evidence: Evidence, rests: Rests) -> Evidence:
    """Return evidence without the samples at rest."""
    residuals = [dict(run) for run in evidence.data.residuals]
    for (r, c), rest in rests.items():
        ok = residuals[r][c].ok.copy()
        ok[np.flatnonzero(ok)[rest]] = False
        residuals[r][c] = replace(residuals[r][c], ok=ok)
    data = Standardised(evidence.views, residuals, evidence.floors)
    return replace(evidence, data=data, nuisance=tuple(_sliced(t, rests) for t in evidence.nuisance))


def _sliced(term: Term, rests: Rests) -> Term:
    """Return a term without the samples at rest."""
    if not any(c in term.channels for _, c in rests):
        return term

    def kept(r: int, c: Channel, x: np.ndarray) -> np.ndarray:
        return x[~rests[r, c]] if (r, c) in rests else x

    parts = [
        [{c: y for c, x in run.items() if len(y := kept(r, c, x))} for r, run in enumerate(part)]
        for part in (term.columns, term.fixed)
    ]
    return Term(term.effect, term.site, term.shape, parts[0], parts[1], term.width, term.limit)
