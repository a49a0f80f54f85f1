"""From odds and costs to answers, and from the answers to the status: one path for verdicts, calibration, challenge."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from sher3_diagnosis.finding import LIBRARY, NO_GAP, OUTSIDE, Item, Judged
from sher3_diagnosis.judge.costs import Costs
from sher3_diagnosis.judge.evidence.scales import beside_others
from sher3_diagnosis.thresholds import COVERED
from sher3_diagnosis.verdict import Status


def answer_to(j: Judged, costs: Costs) -> str:
    """Return the answer to an item that costs least.

    A cause that leaves most of its gap, or whose closure may be nothing, is not named; then the better of the other
    answers holds: a small gap that the cause may not close is likely none.
    """
    closure = j.closure
    left = 1.0 if closure is None else beside_others(1.0 - closure.value, j.item.numbers)
    named = closure is not None and left <= 1.0 - COVERED and (closure.low is None or closure.low > 0.0)
    return costs.cheapest(j.odds, (LIBRARY, OUTSIDE, NO_GAP) if named else (OUTSIDE, NO_GAP))


def answer_to_exact(known: float, costs: Costs) -> str:
    """Return the answer to an exact stage, whose causes are those at work with probability `known`; 0 without one."""
    odds = {LIBRARY: known, OUTSIDE: 1.0 - known}
    return costs.cheapest(odds, odds if known > 0.0 else (OUTSIDE,))


def status_of(items: Sequence[Judged], exact: Sequence[float], same: float, costs: Costs) -> Status:
    """Return the status that costs least by the odds of all causes, gaps and exact stages.

    Args:
        items: causes and gaps with their odds.
        exact: per exact stage, the probability that its causes are those at work.
        same: unlikeness up to which another effect gives the same data.
        costs: of the mistakes.
    """
    answers = [(answer_to(j, costs), j) for j in items]
    crossing = any(a == LIBRARY and crosses(j.item, same) for a, j in answers)
    return combined({a for a, _ in answers} | {answer_to_exact(p, costs) for p in exact}, crossing)


def combined(answers: Collection[str], crossing: bool) -> Status:
    """Return the status that answers to every cause, gap and exact stage come to.

    Args:
        answers: each at least once.
        crossing: whether an effect of another family gives the same data as a named one.
    """
    if OUTSIDE in answers:
        return "outside_library"
    if LIBRARY in answers:
        return "under_excited" if crossing else "attributed"
    return "no_gap"


def crosses(item: Item, same: float) -> bool:
    """Whether an effect of another family than the cause gives the same data: no farther than `same` from it."""
    own = item.candidates[0]
    return any(
        c.unlikeness <= same and c.family != own.family and c.effect not in own.contains for c in item.candidates[1:]
    )
