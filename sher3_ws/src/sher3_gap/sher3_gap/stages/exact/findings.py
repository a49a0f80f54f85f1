"""What the findings of both exact stages have in common: no floor but rounding, and intervals of ticks not told.

Pages that were discovered in such a stage are fitted where no law of time or gain reproduces its gap.
"""

from __future__ import annotations

from collections.abc import Callable, Collection

import numpy as np
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.finding import ExactFinding
from sher3_diagnosis.fit.fitting import Fit
from sher3_diagnosis.quantify.jackknife import standard_error
from sher3_diagnosis.thresholds import EXACT_UNTIMED, JACKKNIFE, REPRODUCED
from sher3_diagnosis.verdict import Cause, Interval, Parameter, Residual, Where
from sher3_effects import Page, computed, library
from sher3_effects.found_page import FoundPage


def exact_finding(where: Where, causes: list[Cause], closure: float) -> ExactFinding:
    """Return a finding; the floor of an exact stage is what its causes leave, since it has no other."""
    left = Residual(gap=where.floor, floor=where.floor, unit=where.unit)
    return ExactFinding(where, causes, exact_interval(closure), left)


def exact_place(stage: str, actuator: str, gap: float, floor: float, regime: str) -> Where:
    """Return the place of an error that is computed: there is no doubt that it is there."""
    return Where(stage=stage, actuator=actuator, gap=gap, floor=floor, unit="m/s", regime=regime, confidence=1.0)


def exact_interval(value: float) -> Interval:
    """Return the interval of a closure: the floor is exact, and only ticks without information widen it."""
    return Interval(value=value, low=value - EXACT_UNTIMED, high=min(1.0, value + EXACT_UNTIMED))


def computed_cause(parameter: str, value: Parameter, actuator: str, closure: float) -> Cause:
    """Return the cause that a computed parameter stands for."""
    return exact_cause(computed(parameter), actuator, closure, **{parameter: value})


def exact_cause(page: Page, actuator: str, closure: float, **parameters: Parameter) -> Cause:
    """Return a cause of an exact stage; family and stage are those of the effect's page."""
    return Cause(
        effect=page.id,
        family=page.family,
        stage=page.stage,
        actuator=actuator,
        parameters=parameters,
        closure=exact_interval(float(np.clip(closure, 0.0, 1.0))),
    )


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
