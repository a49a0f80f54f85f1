"""What one would bet at every place with a gap: answers whose probabilities add up to one, the best explanation kept.

The causes of a place answer for it together: it is one of the library's if none of them is foreign, and none where none
of them is a cause of its own. What they leave is one remainder, so whether it is a foreign law's is one question, which
the most doubtful of them answers; which effect each of them is, is judged of each by itself. So a place is more likely
foreign than not only where one of its causes is, and a headline does not contradict the status.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import product
from math import prod

from sher3_diagnosis.channel import Channel
from sher3_diagnosis.finding import NO_GAP, OUTSIDE, ExactFinding, Finding, Judged
from sher3_diagnosis.fit.fitting import Fit, Term, fit
from sher3_diagnosis.localise.gaps import component_rms
from sher3_diagnosis.quantify.closure import closure, residual_after
from sher3_diagnosis.verdict import Answer, Cause, Interval, Place, Residual, Where

LISTED = 0.005
"""Probability from which an answer is listed; what is less stands in `Place.other`."""
QUANTIFIED = 0.05
"""Probability from which an answer is fitted for its closure; the best explanation always is."""
ROUNDING = 1e-9
"""Of sums of probabilities."""
NONE = -1
Choice = tuple[int, ...]
"""Per cause of a place the candidate chosen; `NONE` where it is no cause of its own."""


def place_of(finding: Finding, items: Sequence[Judged], channel: Channel, where: Where) -> Place:
    """Return the bets at one place.

    Args:
        finding: with all causes that were found, named or not.
        items: its causes and gaps with their odds.
        channel: of the gap.
        where: the place as the verdict states it.
    """
    alone = next((j for j in items if j.item.index is None and j.item.channel == channel), None)
    if alone is not None:
        return placed(where, [_plain(OUTSIDE, alone.outside), _plain(NO_GAP, alone.no_gap)])
    causes = touching(finding, items, channel)
    if not causes:
        return placed(where, [_plain(NO_GAP, 1.0)])
    listed = list(shares(causes))
    best = max(p for _, p in listed)
    answers = [
        _bet(finding, causes, choice, p, channel, quantified=p >= QUANTIFIED or p == best) for choice, p in listed
    ]
    outside = _plain(OUTSIDE, max(j.outside for j in causes))
    typicalities = [j.typicality for j in causes if j.typicality is not None]
    nothing = _plain(NO_GAP, _one_question(causes) * prod(j.no_gap for j in causes))
    return placed(where, [*answers, outside, nothing], min(typicalities, default=None))


def touching(finding: Finding, items: Sequence[Judged], channel: Channel) -> list[Judged]:
    """Return the causes that show on a channel."""
    terms = finding.attribution.fit.terms
    return [j for j in items if j.item.index is not None and channel in terms[j.item.index].channels]


def exact_place(stage: ExactFinding, known: float) -> Place:
    """Return the bets at an exact stage whose causes are those at work with probability `known`."""
    answers = [_plain(OUTSIDE, 1.0 - known)]
    if stage.causes:
        causes = list(stage.causes)
        answers.append(Answer(causes=causes, probability=known, closure=stage.closure, residual=stage.residual))
    return placed(stage.where, answers)


def undecided_place(where: Where) -> Place:
    """Return the bets at a place that cannot be judged: nothing speaks for a gap, and nothing against it."""
    return placed(where, [_plain(OUTSIDE, 0.5), _plain(NO_GAP, 0.5)])


def placed(where: Where, answers: Iterable[Answer], typicality: float | None = None) -> Place:
    """Return a place with the answers worth listing, most probable first; the best explanation always is."""
    ranked = sorted(answers, key=lambda a: -a.probability)
    best = next((a for a in ranked if a.causes), None)
    listed = [a for a in ranked if a.probability >= LISTED or a is best]
    other = 1.0 - sum(a.probability for a in listed)
    fields = where.model_dump(include={"stage", "actuator", "gap", "floor", "unit", "component"})
    return Place(**fields, answers=listed, other=other if other > ROUNDING else 0.0, typicality=typicality)


def shares(causes: Sequence[Judged]) -> Iterator[tuple[Choice, float]]:
    """Yield the combinations of candidates with their probabilities: the most probable, and all worth listing."""
    once = _one_question(causes)
    options = [[(NONE, j.no_gap), *enumerate(j.effects)] for j in causes]
    made = [(tuple(k for k, _ in c), once * prod(p for _, p in c)) for c in product(*options)]
    some = sorted((x for x in made if set(x[0]) != {NONE}), key=lambda x: -x[1])
    yield some[0]
    yield from (x for x in some[1:] if x[1] >= LISTED)


def _one_question(causes: Sequence[Judged]) -> float:
    """Return the odds that none of the causes of a place is foreign, over the product of each one's own."""
    none = [1.0 - j.outside for j in causes]
    return min(none) / prod(none) if all(none) else 0.0


def _plain(answer: str, probability: float) -> Answer:
    return Answer(answer=answer, probability=probability)  # type: ignore[arg-type]


def _bet(
    finding: Finding, causes: Sequence[Judged], choice: Choice, p: float, channel: Channel, quantified: bool
) -> Answer:
    """Return a combination as an answer."""
    chosen = [(j, k) for j, k in zip(causes, choice, strict=True) if k != NONE]
    named = [_cause(finding, j, k) for j, k in chosen]
    if not quantified:
        return Answer(causes=named, probability=p)
    found, residual = closed(finding, channel, _fit(finding, causes, choice))
    return Answer(causes=named, probability=p, closure=found, residual=residual)


def closed(finding: Finding, channel: Channel, after: Fit) -> tuple[Interval, Residual]:
    """Return the closure of a gap under a fit, and what it leaves."""
    evidence, gap = finding.evidence, finding.significant[channel]
    left = component_rms(residual_after(evidence, after, channel), gap.component)
    residual = Residual(gap=left, floor=gap.floor, unit=evidence.unit(channel, gap.component))
    return closure(evidence, channel, evidence.null(), after), residual


def _fit(finding: Finding, causes: Sequence[Judged], choice: Choice) -> Fit:
    """Return the fit with a choice of the causes of one place; those of other places stay."""
    whole = finding.attribution.fit
    if not any(choice):  # all of them as they were found
        return whole
    chosen = {j.item.index: (j, k) for j, k in zip(causes, choice, strict=True)}
    terms = [
        term_of(finding, *chosen[i]) if i in chosen else t
        for i, t in enumerate(whole.terms)
        if i not in chosen or chosen[i][1] != NONE
    ]
    return fit(finding.evidence.data, terms)


def term_of(finding: Finding, j: Judged, k: int) -> Term:
    """Return the term of a candidate."""
    index, candidate = j.item.index, j.item.candidates[k]
    assert index is not None
    own = finding.attribution.fit.terms[index]
    if k == 0:
        return own
    ranked = (f.terms[-1] for f in finding.attribution.ranking[index])
    return next(t for t in ranked if t.key == (candidate.effect, candidate.site))


def _cause(finding: Finding, j: Judged, k: int) -> Cause:
    """Return a candidate as a cause: the one found is quantified, of others effect, site and probability are told."""
    assert j.item.index is not None
    found = finding.cause_of(j.item.index)
    if k == 0:
        return found.model_copy(update={"probability": j.effects[0]})
    candidate, effect = j.item.candidates[k], term_of(finding, j, k).effect
    return Cause(
        effect=candidate.effect,
        family=candidate.family,
        stage=effect.stage,
        actuator=candidate.site,
        parameters={},
        closure=found.closure.model_copy(update={"low": None, "high": None}),
        probability=j.effects[k],
    )
