"""What asks for a judgement: every cause that a fit names, and every gap that no cause explains."""

from __future__ import annotations

import math

from sher3_diagnosis.attribute.rivals import Attribution, unlikeness, without_term
from sher3_diagnosis.channel import AT_TIP, Channel
from sher3_diagnosis.finding import Candidate, Finding, Item
from sher3_diagnosis.fit.fitting import Term
from sher3_diagnosis.judge.evidence.cause import cause_evidence, strongest_channel
from sher3_diagnosis.judge.evidence.scales import LEAST_SHARE
from sher3_diagnosis.thresholds import COVERED


def items_of(finding: Finding) -> list[Item]:
    """Return the causes of a finding, in their order, and then its gaps that they do not explain."""
    evidence, attribution = finding.evidence, finding.attribution
    causes = []
    for i in attribution.causes:
        channel = strongest_channel(
            evidence, attribution.fit.terms[i], without_term(evidence, attribution.fit, i), attribution.fit
        )
        numbers = cause_evidence(evidence, attribution, i).numbers()
        causes.append(Item(channel, i, numbers, candidates_of(attribution, i)))
    return causes + gaps_of(finding, {c.channel for c in causes})


def gaps_of(finding: Finding, taken: set[Channel]) -> list[Item]:
    """Return the significant gaps that no cause explains but for less than half.

    What is fitted without a name, since its size may be zero, explains nothing where nothing else does.
    A gap echoes in another gap only at the same place, and only from the larger to the smaller one: every residual is
    predicted from its stage's measured input, and the tip's from the encoders at the loads. The tip has one residual,
    split in free and loaded samples. A part of less than `LEAST_SHARE` of the other part is what the other part's cause
    leaves.
    """
    evidence, gaps = finding.evidence, finding.significant
    out = []
    for channel, gap in gaps.items():
        null = max(evidence.excess(channel), 1.0)
        left = evidence.excess(channel, finding.attribution.fit) if finding.attribution.causes else null
        if channel in taken or left < (1.0 - COVERED) * null:
            continue
        others = [g.power for c, g in gaps.items() if c != channel and c.actuator == channel.actuator]
        beside = math.log(max(others) / gap.power) if others else 0.0
        if channel.stage in AT_TIP and beside > -math.log(LEAST_SHARE):
            continue
        numbers = {"power": gap.power, "ratio": gap.ratio, "beside": beside, "others": float(len(others))}
        out.append(Item(channel, None, numbers))
    return out


def candidates_of(attribution: Attribution, index: int) -> list[Candidate]:
    """Return the cause and those that come closest to it in its place, each effect and site once.

    What explains as much and is no rival of it was ruled out by the machine's own search.
    """
    term = attribution.fit.terms[index]
    out = {term.key: _candidate(term, 0.0)}
    ranking, total = attribution.ranked(index)
    rivals = {f.terms[-1].effect.id for f in attribution.rivals[index]} | {term.effect.id}
    for f in ranking:
        far = max(0.0, unlikeness(f, total, attribution.explained[index]))
        if far >= 1.0 or f.terms[-1].effect.id in rivals:
            out.setdefault(f.terms[-1].key, _candidate(f.terms[-1], far))
    return list(out.values())


def _candidate(term: Term, far: float) -> Candidate:
    return Candidate(*term.key, term.effect.family, tuple(term.effect.extends), far)
