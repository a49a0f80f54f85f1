"""Pages that were discovered in an exact stage: a fit finds them where no law of time or gain reproduces the gap."""

from __future__ import annotations

from collections.abc import Callable, Collection

from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.finding import ExactFinding
from sher3_diagnosis.fit.fitting import Fit
from sher3_diagnosis.quantify.jackknife import standard_error
from sher3_diagnosis.thresholds import JACKKNIFE, REPRODUCED
from sher3_diagnosis.verdict import Cause, Parameter
from sher3_effects import library
from sher3_effects.found_page import FoundPage

from sher3_gap.stages.exact.findings import exact_cause, exact_finding


def with_pages(finding: ExactFinding, gathered: Callable[[], Evidence], without: Collection[str] = ()) -> ExactFinding:
    """Return the finding with the user's page that reproduces its stage, where its own causes do not."""
    stage = finding.where.stage
    pages = [p for p in library().values() if isinstance(p, FoundPage) and p.stage == stage and p.id not in without]
    if not pages or finding.closed:
        return finding
    evidence = gathered()
    candidates, shown = Candidates(evidence, pages), {c.actuator for c in evidence.channels}
    fits = [(page, site, candidates.best(page, site)) for page in pages for site in page.sites if site in shown]
    known = [(page, site, found) for page, site, found in fits if found is not None]
    if not known:
        return finding
    page, site, best = min(known, key=lambda x: x[2].total)
    null, floor = evidence.null().total, sum(evidence.data.samples.values())
    closure = (null - best.total) / (null - floor)
    if closure < REPRODUCED:
        return finding
    return exact_finding(finding.where, [_cause(page, site, best, closure)], closure)


def _cause(page: FoundPage, site: str, best: Fit, closure: float) -> Cause:
    """Return the page as a cause; the intervals of its coefficients are a jackknife over runs."""
    term, last = best.terms[-1], len(best.terms) - 1
    half = JACKKNIFE * standard_error(best.loro_of(last))
    wide = {f"coefficient_{k + 1}": float(x) for k, x in enumerate(half)}
    found = {}
    for name, value in page.parameters(term.shape, best.of(last)).items():
        low, high = (value - wide[name], value + wide[name]) if name in wide else (None, None)
        found[name] = Parameter(value=value, low=low, high=high, unit=page.unit(name, site, False))
    return exact_cause(page, site, closure, **found)
