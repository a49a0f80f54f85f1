"""Pages that were discovered in an exact stage: found again by a fit, where no law of time or gain reproduces it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence

import numpy as np
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.finding import ExactFinding
from sher3_diagnosis.fit.fitting import Fit
from sher3_diagnosis.thresholds import JACKKNIFE, REPRODUCED
from sher3_diagnosis.verdict import Cause, Parameter
from sher3_effects import library
from sher3_effects.found_page import FoundPage

from sher3_gap.stages.exact_findings import exact_cause, exact_finding


def with_pages(finding: ExactFinding, gathered: Callable[[], Evidence], without: Collection[str] = ()) -> ExactFinding:
    """Return the finding with the user's page that reproduces its stage, where its own causes do not."""
    stage = finding.where.stage
    pages = [p for p in library().values() if isinstance(p, FoundPage) and p.stage == stage and p.id not in without]
    if not pages or finding.closure.value >= REPRODUCED:
        return finding
    evidence = gathered()
    fits = [(page, site, best_of(evidence, pages, page, site)) for page in pages for site in page.sites]
    known = [(page, site, found) for page, site, found in fits if found is not None]
    if not known:
        return finding
    page, site, best = min(known, key=lambda x: x[2].total)
    null, floor = evidence.null().total, sum(evidence.data.samples.values())
    closure = (null - best.total) / (null - floor)
    if closure < REPRODUCED:
        return finding
    return exact_finding(finding.where, [_cause(page, site, best, closure)], closure)


def best_of(evidence: Evidence, pages: Sequence[Effect], page: FoundPage, site: str) -> Fit | None:
    """Return the best fit of a page at a site; None where that shows no error."""
    shown = {c.actuator for c in evidence.channels}
    return Candidates(evidence, pages).best(page, site) if site in shown else None


def _cause(page: FoundPage, site: str, best: Fit, closure: float) -> Cause:
    """Return the page as a cause; the intervals of its coefficients are a jackknife over runs."""
    term = best.terms[-1]
    draws = best.loro_of(len(best.terms) - 1)
    n = len(draws)
    half = JACKKNIFE * np.sqrt((n - 1) / n * np.sum((draws - draws.mean(axis=0)) ** 2, axis=0))
    values = page.parameters(term.shape, best.of(len(best.terms) - 1))
    found = {}
    for name, value in values.items():
        wide = float(half[int(name.rsplit("_", 1)[1]) - 1]) if name.startswith("coefficient_") else None
        ends = (None, None) if wide is None else (value - wide, value + wide)
        found[name] = Parameter(value=value, low=ends[0], high=ends[1], unit=page.unit(name, site, False))
    return exact_cause(page.id, site, closure, **found)
