"""Numbers of dry and viscous friction from samples well away from a reversal, where their laws are exact.

Around a reversal dry friction is no sign of the speed: the axis sticks, the filter smears the step, and a sample more
or less late makes the step small at low speed, which looks like viscosity. Causes are chosen on all samples, since laws
that live at low speed show there; the numbers of those that do not are then fitted again without them. Where a slow
record or a noisy encoder asked for a lower cut-off than the engine's, they take the place of the first ones; elsewhere
the first ones stay, and an interval holds both: what the two differ by is what the law at a reversal is not known by.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.channel import Channel, Mask, Residual
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.filter import BANDWIDTH
from sher3_diagnosis.fit.fitting import fit, make_term
from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.fit.term import again
from sher3_diagnosis.quantify.parameters import parameters
from sher3_diagnosis.verdict import Cause, Parameter
from sher3_effects import pages

from sher3_chain.thresholds import MIN_BLOCK, SLOW

E = TypeVar("E", bound=Evidence)
FRICTION = "friction"
"""Family of the forces that resist."""


def requantified(evidence: Evidence, attribution: Attribution, causes: Sequence[Cause]) -> list[Cause]:
    """Return the causes with parameters and intervals from samples away from a reversal, where their laws allow it.

    Args:
        evidence: that the causes were chosen on.
        attribution: of the causes, in their order.
        causes: as quantified on all samples.
    """
    terms = attribution.fit.terms
    slow = {t.site for t in terms if t.effect.slow}  # nothing is fitted again beside a law that lives there
    dry = {t.site for t in terms if t.effect.dry} - slow
    if not dry:
        return list(causes)
    views: Sequence[Any] = evidence.views
    smeared = any(view.run.bandwidth < BANDWIDTH for view in views)
    away = without_slow(evidence, dry)
    found = fit(away.data, again(away.data, terms))
    out = []
    for i, cause in zip(attribution.causes, causes, strict=True):
        if terms[i].site in dry and terms[i].effect.admissible(terms[i].shape, found.of(i)):
            new = parameters(away, found, i)
            refitted = new if smeared else {n: _holding(p, new[n]) for n, p in cause.parameters.items() if n in new}
            cause = cause.model_copy(update={"parameters": refitted})
        out.append(cause)
    return out


def with_unseen(evidence: Evidence, attribution: Attribution, causes: Sequence[Cause]) -> list[Cause]:
    """Return the causes with intervals of dry friction widened by a viscous friction that is too small to be found.

    At one speed the two are the same force, so that the one is a proxy for a part of the other.
    """
    terms = attribution.fit.terms
    viscous = next(e for e in pages("axis") if e.plain and e.family == FRICTION and not e.dry)
    rubbed = {t.site for t in terms if t.effect.id == viscous.id}
    out = []
    for i, cause in zip(attribution.causes, causes, strict=True):
        term = terms[i]
        if term.effect.dry and term.site not in rubbed and "force" in cause.parameters and cause.condition is None:
            beside = fit(evidence.data, [*terms, make_term(evidence.data, viscous, term.site, {})])
            if beside.of(len(terms))[0] > 0.0 and term.effect.admissible(term.shape, beside.of(i)):
                other = parameters(evidence, beside, i)["force"]
                widened = {**cause.parameters, "force": _holding(cause.parameters["force"], other)}
                cause = cause.model_copy(update={"parameters": widened})
        out.append(cause)
    return out


def _holding(first: Parameter, other: Parameter) -> Parameter:
    """Return a parameter whose interval holds that of another estimate of it too."""
    if first.low is None or first.high is None or other.low is None or other.high is None:
        return first
    return first.model_copy(update={"low": min(first.low, other.low), "high": max(first.high, other.high)})


def without_slow(evidence: E, sites: set[str]) -> E:
    """Return the evidence without the slow samples of some sites' force balance."""
    data = evidence.data
    residuals = [
        {c: _fast(x, view, c) if c.actuator in sites else x for c, x in found.items()}
        for view, found in zip(data.views, data.residuals, strict=True)
    ]
    return replace(evidence, data=Standardised(data.views, residuals, data.floors))


def _fast(residual: Residual, view: Any, channel: Channel) -> Residual:
    if channel.stage != "motor_mechanics":
        return residual
    kept: Mask = residual.ok & away_from_reversal(view, channel.actuator)
    return replace(residual, ok=kept) if kept.sum() >= MIN_BLOCK else residual


def away_from_reversal(view: Any, site: str) -> Mask:
    """Return (g,) True where an axis moves faster than a share of its rms speed."""
    speed = np.abs(view.velocity[:, view.row(site)])
    return np.asarray(speed > SLOW * np.sqrt(np.mean(speed**2)))
