"""Which causes the data bear out, where no calibration weighs them.

Beside what `meaning` asks of each cause by itself: a cause is worth more than laws are off by; the causes of a gap that
is not closed surely take a part of it; and what they leave does not follow quantities which none of them may depend on.
What fails the first is left out; what fails the others imitates an effect that the library does not have.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace

from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.attribute.together import is_plain, law_error
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.finding import Finding
from sher3_diagnosis.fit.fitting import Fit
from sher3_diagnosis.judge.foreign_inputs import foreign_in
from sher3_diagnosis.quantify.closure import closure
from sher3_diagnosis.thresholds import AT_FLOOR, FOREIGN_SHARE, FOREIGN_SIZE, PART_CLOSED
from sher3_diagnosis.verdict import Imitation


def significant_causes(
    evidence: Evidence, attribution: Attribution, left: Callable[[Fit], Collection[Channel]]
) -> Attribution:
    """Return the attribution without insignificant causes, where their gap stays closed without them.

    Such a cause is worth next to nothing, and an effect of another family, where nobody can tell which, is worth as
    much: what the law of a larger cause leaves out.
    """
    for i in reversed([i for i in attribution.causes if untold(evidence, attribution, i)]):
        if len(attribution.causes) > 1:
            fewer = attribution.kept(evidence, [k for k in attribution.causes if k != i])
            if set(left(fewer.fit)) <= set(left(attribution.fit)):
                attribution = fewer
    return attribution


def untold(evidence: Evidence, attribution: Attribution, index: int) -> bool:
    """Return whether a cause gains less than laws may be off by, and no more than one of another family would."""
    family = attribution.fit.terms[index].effect.family
    others = any(f.terms[-1].effect.family != family for f in attribution.rivals[index])
    plain = is_plain(evidence, attribution.fit.terms[index])
    return others and attribution.explained[index] < law_error(evidence, attribution.fit, plain)


def without_imitations(finding: Finding, free_laws: bool) -> Finding:
    """Return a finding with only the causes that the data bear out; the others become imitations.

    Args:
        finding: on a part of a machine.
        free_laws: whether what the causes leave is looked at by free laws.
    """
    evidence, found = finding.evidence, finding.attribution
    fake, left = [], dict(finding.left)
    for channel in finding.significant:
        own = [i for i in found.causes if channel in found.fit.terms[i].channels]
        if not own:
            continue
        share = closure(evidence, channel, evidence.null(), found.fit)
        small = channel in left and min(share.value, share.low or share.value) < PART_CLOSED
        if small or (free_laws and foreign_law(evidence, found, channel)):
            fake += own
            left[channel] = max(1.0, evidence.excess(channel))
    if not fake:
        return finding
    place = dict(zip(found.causes, finding.causes, strict=True))
    true = [i for i in found.causes if i not in fake]
    imitations = [
        Imitation(effect=c.effect, actuator=c.actuator, closure=c.closure) for i, c in place.items() if i in fake
    ]
    return replace(
        finding,
        attribution=found.kept(evidence, true),
        causes=[place[i] for i in true],
        left=left,
        imitations=(*finding.imitations, *imitations),
    )


def foreign_law(evidence: Evidence, attribution: Attribution, channel: Channel) -> bool:
    """Return whether what is left of a gap follows quantities that none of its causes may depend on."""
    found = foreign_in(evidence, attribution, channel)
    if found is None or found.own < AT_FLOOR:
        return False
    return found.size > FOREIGN_SIZE and found.share > FOREIGN_SHARE
