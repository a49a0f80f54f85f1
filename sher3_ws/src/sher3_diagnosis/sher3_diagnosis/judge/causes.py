"""Causes and places as a verdict states them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sher3_diagnosis.attribute.rivals import Attribution, without_term
from sher3_diagnosis.channel import AT_TIP, Channel
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.finding import Finding
from sher3_diagnosis.fit.tolerance import NUISANCE
from sher3_diagnosis.judge.evidence.cause import strongest_channel
from sher3_diagnosis.localise.gaps import Gap
from sher3_diagnosis.localise.regimes import regime
from sher3_diagnosis.quantify.closure import closure
from sher3_diagnosis.quantify.over_rivals import over_rivals
from sher3_diagnosis.quantify.parameters import parameters
from sher3_diagnosis.verdict import Cause, Where


def causes_of(evidence: Evidence, attribution: Attribution) -> list[Cause]:
    """Quantify every cause of an attribution, in its order."""
    return [_cause(evidence, attribution, i) for i in attribution.causes]


def _cause(evidence: Evidence, attribution: Attribution, index: int) -> Cause:
    found = attribution.fit
    term = found.terms[index]
    without = without_term(evidence, found, index)
    channel = strongest_channel(evidence, term, without, found)
    moving = attribution.moving
    quantified = (evidence, found) if moving is None else (moving.evidence, moving.fit)
    rivals = [f.terms[-1].effect.id for f in attribution.rivals[index]]
    return Cause(
        effect=term.effect.id,
        family=term.effect.family,
        stage=term.effect.stage_at(channel),
        actuator=term.site,
        parameters=over_rivals(attribution, index, parameters(*quantified, index)),
        closure=closure(evidence, channel, without, found),
        rivals=list(dict.fromkeys(rivals)),
        condition=term.effect.condition,
    )


def places_of(finding: Finding, gaps: Mapping[Channel, Gap]) -> list[tuple[Channel, Where]]:
    """Return the places with a gap, largest gap over floor first; those of a companion after its leader's."""
    behind = {(t.effect.companion, t.site) for t in finding.attribution.fit.terms if t.effect.companion}
    sites = {site for _, site in behind}
    entries = []
    for channel, gap in gaps.items():
        follows = channel.stage == "motor_mechanics" and channel.actuator in sites
        entries.append(((follows, -gap.ratio), (channel, _where(finding, channel, gap))))
    return [place for _, place in sorted(entries, key=lambda e: e[0])]


def _where(finding: Finding, channel: Channel, gap: Gap) -> Where:
    evidence, terms = finding.evidence, finding.attribution.fit.terms
    stage, actuator = channel.stage, channel.actuator
    if channel.stage in AT_TIP:  # one reading: a gap there belongs to the effect that explains it
        shown = [t for t in terms if channel in t.effect.channels(t.site)]
        if shown and shown[0].effect.family != NUISANCE:
            actuator = shown[0].site
            stage = shown[0].effect.stage if shown[0].effect.stage in AT_TIP else stage
    return Where(
        stage=stage,
        actuator=actuator,
        gap=gap.gap,
        floor=gap.floor,
        unit=evidence.unit(channel, gap.component),
        component=evidence.component(channel, gap.component),
        regime=regime(evidence, channel),
        confidence=float(1.0 - np.exp(-gap.power)),
    )


def ordered(causes: list[Cause], findings: list[Finding]) -> list[Cause]:
    """Return the causes with most closure first; a companion comes after the cause that it shows beside."""
    terms = [t for f in findings for t in f.attribution.fit.terms]
    behind = {(t.effect.companion, t.site) for t in terms if t.effect.companion}
    have = {(t.effect.family, t.site) for t in terms}
    behind |= {(t.effect.family, t.site) for t in terms if {(f, t.site) for f in t.effect.shown_by} & have}
    return sorted(causes, key=lambda c: ((c.family, c.actuator) in behind, -round(c.closure.value, 2)))
