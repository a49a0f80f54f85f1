"""The status of a verdict from the answers to its causes and gaps: a matter of causes, not of remainders."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_diagnosis.judge.items import Item
from sher3_diagnosis.judge.probabilities import LIBRARY, NO_GAP, OUTSIDE, Judged
from sher3_diagnosis.thresholds import COVERED
from sher3_diagnosis.verdict import Interval, Status


def answer_to(j: Judged, closure: Interval | None) -> str:
    """Return the answer to an item; a cause is not named that leaves most of its gap, or whose closure may be nothing.

    Then the more probable of the other answers holds: a small gap that the cause may not close is likely none.

    Args:
        j: the item with its probabilities.
        closure: of a cause; exactly 0 where over all runs there is nothing above the floor that could be closed.
    """
    if closure is None:
        return j.answer
    if closure.value == 0.0:
        return NO_GAP
    if j.answer == LIBRARY and (closure.value < COVERED or (closure.low is not None and closure.low <= 0.0)):
        return OUTSIDE if j.outside >= j.no_gap else NO_GAP
    return j.answer


def status_of(answers: Sequence[str], crossing: bool) -> Status:
    """Return the status.

    Args:
        answers: to every cause, gap and exact stage.
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
