"""Which causes are worth nothing: they explain less than laws are off by, and a cause of another family explains as
much.
"""

from __future__ import annotations

from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.attribute.together import Left, is_plain, law_error
from sher3_diagnosis.evidence import Evidence


def significant_causes(evidence: Evidence, attribution: Attribution, left: Left) -> Attribution:
    """Return the attribution without insignificant causes, where their gap stays closed without them.

    Such a cause is worth next to nothing, and an effect of another family, where nobody can tell which, is worth as
    much: what the law of a larger cause leaves out.
    """
    for i in reversed([i for i in attribution.causes if insignificant(evidence, attribution, i)]):
        if len(attribution.causes) > 1 and (fewer := closed_without(evidence, attribution, i, left)) is not None:
            attribution = fewer
    return attribution


def closed_without(evidence: Evidence, attribution: Attribution, index: int, left: Left) -> Attribution | None:
    """Return the attribution without a cause; None where a gap opens then."""
    fewer = attribution.kept(evidence, [k for k in attribution.causes if k != index])
    return fewer if set(left(fewer.fit)) <= set(left(attribution.fit)) else None


def insignificant(evidence: Evidence, attribution: Attribution, index: int) -> bool:
    """Return whether a cause explains less than the error of laws, and a rival of another family explains as much."""
    family = attribution.fit.terms[index].effect.family
    others = any(f.terms[-1].effect.family != family for f in attribution.rivals[index])
    plain = is_plain(evidence, attribution.fit.terms[index])
    return others and attribution.explained[index] < law_error(evidence, attribution.fit, plain)
