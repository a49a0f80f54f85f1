"""What the motion of a free axis tells of rivals: each is run again from the release, and one of them comes nearer.

Two frictions may take as much off a force balance that twice differentiated counts make. The motion they foretell parts
from the measured one within a swing.
"""

from __future__ import annotations

from typing import Any

from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.fit.fitting import Fit
from sher3_diagnosis.verdict import Cause, Interval, Parameter

from sher3_chain.axes.causes.refine import loss_of_motion, refine_free
from sher3_chain.axes.simulate import simulated

NEARER = 0.25
"""Share of the mean square error of the position below which a rival takes a cause's place: half of it in rms."""


def parted_by_release(evidence: Any, found: Attribution) -> Attribution:
    """Return the causes of a free axis with those rivals in their place whose motion comes markedly nearer."""
    if not evidence.axis.free or evidence.mass <= 0.0 or not any(found.rivals):
        return found
    best, least = found, NEARER * _error(evidence, found, found.fit)
    for i in found.causes:
        for rival in found.rivals[i]:
            trial = found.arranged(evidence, range(len(found.fit.terms)), {i: rival.terms[-1]})
            error = _error(evidence, trial, trial.fit)
            best, least = (trial, error) if trial.fit.admissible and error < least else (best, least)
    return best


def _error(evidence: Any, found: Attribution, fit: Fit) -> float:
    """Return the mean square error of the position run again; infinite where a cause cannot be run."""
    causes = []
    for i in found.causes:
        term = fit.terms[i]
        if term.effect.id not in simulated():
            return float("inf")
        values = term.effect.parameters(term.shape, fit.of(i))
        parameters = {name: Parameter(value=value, unit="1") for name, value in values.items()}
        page, none = term.effect, Interval(value=0.0)
        causes.append(
            Cause(
                effect=page.id,
                family=page.family,
                stage=page.stage,
                actuator=term.site,
                parameters=parameters,
                closure=none,
            )
        )
    nearer, refined = refine_free(evidence, causes)
    return loss_of_motion(nearer, nearer.mass, refined)
