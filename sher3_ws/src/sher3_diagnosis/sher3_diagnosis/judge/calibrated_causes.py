"""Causes and gaps weighed by the calibration: what is named, what merely imitates, and what is no cause of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.finding import LIBRARY, OUTSIDE, Finding, Item, Judged
from sher3_diagnosis.judge.calibration.calibration import Calibration
from sher3_diagnosis.judge.costs import Costs
from sher3_diagnosis.judge.items import items_of
from sher3_diagnosis.judge.probabilities import judged_together
from sher3_diagnosis.judge.status import answer_to
from sher3_diagnosis.verdict import Cause, Imitation, Interval


def weighed(findings: Sequence[Finding], calibration: Calibration, own_level: bool, costs: Costs) -> list[Finding]:
    """Judge all causes and gaps of a machine; keep those causes that are named, and the gaps that need an answer."""
    items = [[(f, i) for i in items_of(f)] for f in findings]
    every = [x for own in items for x in own]
    judgements = iter(judged_together([i for _, i in every], [_closure(*x) for x in every], calibration, own_level))
    return [
        _kept_of(f, [_nothing_without_gap(f, next(judgements)) for _ in own], calibration.reach, costs)
        for f, own in zip(findings, items, strict=True)
    ]


def _nothing_without_gap(finding: Finding, j: Judged) -> Judged:
    """Return a cause with its odds; where no gap shows, what is none of the library's is nothing."""
    if _touches(finding, j).isdisjoint(finding.significant):
        return replace(j, outside=0.0, no_gap=j.no_gap + j.outside)
    return j


def _kept_of(finding: Finding, items: Sequence[Judged], reach: float, costs: Costs) -> Finding:
    """Return a finding with the causes that are named and the gaps that need an answer."""
    answers = [answer_to(j, costs) for j in items]
    named = [j for j, a in zip(items, answers, strict=True) if a == LIBRARY]
    outside = [j for j, a in zip(items, answers, strict=True) if a == OUTSIDE]
    attribution, causes = _kept(finding, named, reach)
    touched = {c for j in (*named, *outside) for c in _touches(finding, j)}
    return replace(
        finding,
        attribution=attribution,
        causes=causes,
        left={j.item.channel: finding.evidence.excess(j.item.channel, attribution.fit) for j in outside},
        judged=tuple(items),
        whole=finding,
        imitations=tuple(_imitation(finding, j) for j in outside if j.item.index is not None),
        dismissed=frozenset(finding.significant) - touched,
    )


def _closure(finding: Finding, item: Item) -> Interval | None:
    """Closure of a cause; None of a gap."""
    return None if item.index is None else _cause(finding, item).closure


def _cause(finding: Finding, item: Item) -> Cause:
    assert item.index is not None
    return finding.cause_of(item.index)


def _touches(finding: Finding, j: Judged) -> frozenset[Channel]:
    if j.item.index is None:
        return frozenset({j.item.channel})
    return finding.attribution.fit.terms[j.item.index].channels


def _imitation(finding: Finding, j: Judged) -> Imitation:
    cause = _cause(finding, j.item)
    return Imitation(effect=cause.effect, actuator=cause.actuator, closure=cause.closure)


def _kept(finding: Finding, named: Sequence[Judged], reach: float) -> tuple[Attribution, list[Cause]]:
    """Return the attribution with the named causes alone, their rivals within reach, and the causes."""
    found = finding.attribution
    rivals = {j.item.index: _rivals(found, j, reach) for j in named}
    indices = [j.item.index for j in named if j.item.index is not None]
    none = ((),) * found.nuisance
    attribution = replace(
        found.kept(finding.evidence, indices), moving=None, rivals=(*none, *(rivals[i] for i in indices))
    )
    causes = []
    for j in named:
        cause, ranked = _cause(finding, j.item), {c.effect for c in j.item.candidates}
        alike = [f.terms[-1].effect.id for f in rivals[j.item.index]] + [r for r in cause.rivals if r not in ranked]
        update = {"rivals": list(dict.fromkeys(alike)), "probability": j.effects[0]}
        causes.append(cause.model_copy(update=update))
    return attribution, causes


def _rivals(found: Attribution, j: Judged, reach: float) -> tuple:
    """Return the fits of the candidates within reach, of other effects than the cause."""
    within = {(c.effect, c.site) for c in j.item.candidates if c.unlikeness <= reach}
    own = j.item.candidates[0].effect
    assert j.item.index is not None
    ranking, _ = found.ranked(j.item.index)
    return tuple(f for f in ranking if f.terms[-1].key in within and f.terms[-1].effect.id != own)
