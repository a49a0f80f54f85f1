"""The status of a verdict from the answers to its causes and gaps: a matter of causes, not of remainders."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_diagnosis.judge.items import Item
from sher3_diagnosis.judge.probabilities import LIBRARY, OUTSIDE, Judged
from sher3_diagnosis.verdict import Status


def answer_to(j: Judged, low: float | None) -> str:
    """Return the answer to an item; a cause whose closure may be nothing at all (`low` <= 0) is not named."""
    if j.answer == LIBRARY and low is not None and low <= 0.0:
        return OUTSIDE
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
