"""The verdict: status, places, causes and what is left, from the findings on every part of a machine."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from sher3_diagnosis.channel import Channel
from sher3_diagnosis.finding import LIBRARY, ExactFinding, Finding
from sher3_diagnosis.judge.bets import closed, exact_place, place_of, undecided_place
from sher3_diagnosis.judge.calibration.calibration import in_force
from sher3_diagnosis.judge.calibration.typical import RARE
from sher3_diagnosis.judge.causes import ordered, places_of
from sher3_diagnosis.judge.costs import DEFAULT, Costs
from sher3_diagnosis.judge.experiments.next_experiment import next_experiment
from sher3_diagnosis.judge.meaning import open_sizes
from sher3_diagnosis.judge.probabilities import first_place_odds, reproduced
from sher3_diagnosis.judge.remainder import remainder
from sher3_diagnosis.judge.status import answer_to_exact, status_of
from sher3_diagnosis.localise.gaps import Gap
from sher3_diagnosis.machine import Machine
from sher3_diagnosis.verdict import Closure, Interval, Place, Residual, Unexplained, Verdict, Where
from sher3_diagnosis.words import place, share, words

TINY = np.finfo(float).tiny
Gaps = dict[Channel, Gap]


def judge(
    machine: Machine,
    findings: Sequence[Finding],
    exact: Sequence[ExactFinding],
    notes: list[str],
    costs: Costs = DEFAULT,
) -> Verdict:
    """Build the verdict of a machine from what was found on its parts and in its exact stages."""
    calibration = in_force()
    stages = [(e, reproduced(e, calibration)) for e in exact]
    causes = [c.model_copy(update={"probability": p}) for e, p in stages for c in e.causes]
    causes += [c for f in findings for c in f.causes]
    gaps = [f.significant for f in findings]
    located = _located(findings)
    places = [exact_place(e, p) for e, p in stages] + _bets(located) if exact or any(gaps) else _improbable(findings)
    common: dict[str, Any] = {
        "places": places,
        "within_tolerance": [w for f in findings for w in machine.within(f)],
        "identified": [x for f in findings for x in machine.identified(f.evidence)],
        "probabilities": first_place_odds(places),
        "costs": costs.as_dict(),
        "notes": [*notes, *_atypical(places), *(n for f in findings for n in open_sizes(f.attribution, f.causes))],
    }
    if not any(gaps) and not exact:
        return _hidden(machine, findings, common) or Verdict(status="no_gap", **common)
    causes = ordered(causes, list(findings))
    where = [f.where for f in exact] + [w for _, _, w in located]
    stage, residual = _first(findings, gaps, exact, where[0].gap)
    unexplained = _unexplained(findings, gaps, stages, costs)
    items = [j for f in findings for j in f.judged]
    proposals = (p for f in findings if (p := next_experiment(machine, f)) is not None)
    return Verdict(
        status=status_of(items, [p for _, p in stages], calibration.same, costs),
        where=where,
        causes=causes,
        closure=Closure(stage=stage, tip=machine.end_to_end(findings, causes)),
        residual=residual,
        unexplained=unexplained,
        next_experiment=next(proposals, None),
        **common,
    )


Located = tuple[Finding, Channel, Where]


def _hidden(machine: Machine, findings: Sequence[Finding], common: dict[str, Any]) -> Verdict | None:
    """Return the verdict on parts of which no gap is no finding, since their floor hides one; None without any."""
    why = [(f, machine.unjudgeable(f)) for f in findings]
    hidden = [
        (c, w, said[c]) for f, said in why for c, w in places_of(f, {g.channel: g for g in f.gaps if g.channel in said})
    ]
    if not hidden:
        return None
    channel, _, reason = hidden[0]
    where = [w for _, w, _ in hidden]
    unexplained = Unexplained(stage=channel.stage, actuator=channel.actuator, signature=reason)
    common = {**common, "places": [undecided_place(w) for w in where]}
    return Verdict(status="outside_library", where=where, unexplained=unexplained, **common)


def _located(findings: Sequence[Finding]) -> list[Located]:
    """Return the places of all parts, largest gap over floor first; those of one part as it orders them."""
    found = [(f, c, w) for f in findings for c, w in places_of(f, f.significant)]
    return found if len(findings) == 1 else sorted(found, key=lambda x: -x[2].gap / max(x[2].floor, TINY))


def _bets(located: Sequence[Located]) -> list[Place]:
    """Return the bets at every place that was fitted."""
    return [place_of(f.with_all, f.judged, c, w) for f, c, w in located]


def _improbable(findings: Sequence[Finding]) -> list[Place]:
    """Return the bets at gaps above their floor that are judged to be none."""
    some = [(f, j.item.channel) for f in findings for j in f.judged]
    seen = [(f, c, w) for f, x in some for c, w in places_of(f, f.with_all.significant) if c == x]
    unique = {(id(f), c): (f, c, w) for f, c, w in seen}
    return _bets(list(unique.values()))


def _atypical(places: Sequence[Place]) -> list[str]:
    """Say where few of the labelled causes are as unusual as what was found, so that its odds are held back."""
    return [
        f"{words(p.stage)}, {place(p.actuator)}: {share(p.typicality)} of the labelled causes are as unusual, "
        "so its odds are held back"
        for p in places
        if p.typicality is not None and p.typicality < RARE
    ]


def _first(
    findings: Sequence[Finding], gaps: Sequence[Gaps], exact: Sequence[ExactFinding], size: float
) -> tuple[Interval | None, Residual | None]:
    """Closure and remainder at the first place of the verdict, whose gap is `size`."""
    if exact:
        return exact[0].closure, exact[0].residual
    for finding, own in zip(findings, gaps, strict=True):
        channel = next((c for c, g in own.items() if g.gap == size), None)
        if channel is not None:
            return closed(finding, channel, finding.attribution.fit)
    return None, None


def _unexplained(
    findings: Sequence[Finding],
    gaps: Sequence[Gaps],
    stages: Sequence[tuple[ExactFinding, float]],
    costs: Costs,
) -> Unexplained | None:
    """What is left that no effect explains: in an exact stage, with the odds of its causes, or of a gap."""
    for stage, known in stages:
        if answer_to_exact(known, costs) != LIBRARY:
            reason = f"an exact stage is not reproduced: {stage.note or 'no timing or gain error fits'}"
            return Unexplained(stage=stage.where.stage, actuator=stage.where.actuator, signature=reason)
    for finding, own in zip(findings, gaps, strict=True):
        left = {c: x for c, x in finding.left.items() if c in own}
        if left:
            return _described(finding, max(left, key=left.__getitem__))
    if not any(f.causes for f in findings) and not stages:
        finding, own = next((f, own) for f, own in zip(findings, gaps, strict=True) if own)
        return _described(finding, max(own, key=lambda c: own[c].power))
    return None


def _described(finding: Finding, channel: Channel) -> Unexplained:
    text = remainder(finding.evidence, channel, finding.attribution.fit)
    imitated = sorted(finding.imitations, key=lambda i: -i.closure.value)
    return Unexplained(stage=channel.stage, actuator=channel.actuator, signature=text, imitated_by=imitated)
