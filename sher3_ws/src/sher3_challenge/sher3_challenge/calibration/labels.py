"""What the label of a case says of each cause and gap that the engine found in it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sher3_diagnosis.finding import LIBRARY, NO_GAP, OUTSIDE
from sher3_diagnosis.thresholds import RIVAL
from sher3_effects import library

from sher3_challenge.calibration.observe import Observation

Row = Mapping[str, Any]

SAME_DATA = 1.0
"""Unlikeness below which two effects explain the data alike: which of them it is, nothing recorded tells."""


def answer_of(seen: Observation, item: Row, whole: Observation) -> str | None:
    """Return the right answer to a cause or a gap; None where the label does not settle it.

    Args:
        seen: the observation that the item is of.
        item: one of its items.
        whole: the observation of the same case with the whole library.
    """
    if item["index"] is None:
        return _gap_label(seen, item, whole)
    named, true = item["candidates"][0]["effect"], known_effects(seen)
    if equal(named, true) or any(equal(name, true) for name in alike(item)):
        return LIBRARY
    status = seen.truth["status"]
    if status == "no_gap":
        return NO_GAP
    if named in company(seen) or (status == "under_excited" and named in seen.truth["rivals"]):
        return None if seen.without or status == "outside_library" else LIBRARY
    if status == "outside_library":
        return OUTSIDE
    if seen.without:
        return None if contains(named, seen.without) or twins(named, whole) or same_data(seen, whole) else OUTSIDE
    return None if _at_a_fault(seen, item) else NO_GAP


def known_effects(seen: Observation) -> set[str]:
    """Return the true effects that the library holds."""
    return {e["effect"] for e in seen.truth["effects"] if e["family"] != "outside"} - set(seen.without)


def company(seen: Observation) -> set[str]:
    """Return the effects that come with a true one."""
    return {name for e in seen.truth["effects"] for name in e.get("company", ())}


def equal(named: str, true: set[str]) -> bool:
    """Whether an effect is a true one or contains it."""
    return named in true or contains(named, true)


def contains(named: str, effects: set[str] | tuple[str, ...]) -> bool:
    """Whether an effect contains one of some effects, so that naming it is no mistake."""
    page = library().get(named)
    return page is not None and bool(set(page.extends) & set(effects))


def alike(item: Row, within: float = SAME_DATA) -> set[str]:
    """Return the effects of the candidates that explain the data alike, the one named among them."""
    return {c["effect"] for c in item["candidates"] if c["unlikeness"] <= within}


def twins(named: str, whole: Observation) -> bool:
    """Whether, with the whole library, an effect explains the data as well as the cause named there."""
    return any(named in alike(item) for item in whole.items if item["index"] is not None)


def same_data(seen: Observation, whole: Observation) -> bool:
    """Whether a library without an effect explains every gap as well as the whole one: nothing recorded tells them.

    Several causes together may do so where no single one does. What they leave may exceed what the whole library leaves
    by the share of the gap by which a rival may be worse, and no gap may be without a cause.
    """
    if not seen.items or any(x["index"] is None for x in seen.items):
        return False
    left, before = _remainders(seen), _remainders(whole)
    return all(rest <= before.get(c, (0.0, gap))[0] + RIVAL * gap for c, (rest, gap) in left.items())


def _remainders(seen: Observation) -> dict[str, tuple[float, float]]:
    """Return per channel with a cause the largest power over its floor that its causes leave, and that they explain."""
    out: dict[str, tuple[float, float]] = {}
    for item in (x for x in seen.items if x["index"] is not None):
        gap = max(item["numbers"]["power"], 0.0)
        rest, most = out.get(item["channel"], (0.0, 0.0))
        out[item["channel"]] = max(rest, gap * max(0.0, item["numbers"]["left"])), max(most, gap)
    return out


def _at_a_fault(seen: Observation, item: Row) -> bool:
    """Whether an item sits where a fault of the label shows: a misnamed cause, not an idle one."""
    stage, actuator = item["channel"].split("/")
    for e in seen.truth["effects"]:
        stages = {e["stage"], *e["also"]}
        tip = stage in ("mechanism", "structure") and stages & {"mechanism", "structure"}
        if tip or (stage in stages and actuator == e["actuator"]):
            return True
    return False


def _gap_label(seen: Observation, item: Row, whole: Observation) -> str | None:
    """A gap without a cause is outside where a fault shows there, and none of its own where no fault does.

    A gap that the whole library explains, and the library without an effect does not, is one of that effect.
    """
    if seen.truth["status"] == "no_gap":
        return NO_GAP
    if seen.truth["status"] == "under_excited":
        return None
    channel = item["channel"]
    unexplained = {x["channel"] for x in whole.items if x["index"] is None}
    if seen.without and channel in whole.places and channel not in unexplained:
        return OUTSIDE
    return OUTSIDE if _at_a_fault(seen, item) else NO_GAP
