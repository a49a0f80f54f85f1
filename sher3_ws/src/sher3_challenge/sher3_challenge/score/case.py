"""What one verdict got right against its sealed label.

Verdicts and labels are plain mappings (schemas `sher3.verdict/1` and `sher3.truth/1`), so that verdicts of any program
can be scored.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sher3_description import ACTUATORS

from sher3_challenge.score.intervals import parameter_coverage

Truth = Mapping[str, Any]
Verdict = Mapping[str, Any]

NAMED = 2
"""Rivals of an under-excited case that must be named."""


@dataclass(frozen=True)
class CaseScore:
    """What one verdict got right; None where a question does not apply.

    Attributes:
        case: name.
        plant: name of the truth plant, `-` where the label has none.
        truth: status by the label.
        said: status by the verdict, `missing` without one.
        fault: what is wrong, joined by `+`; `-` when healthy.
        answer: effects named, joined by `+`.
        families: true families, joined by `+`.
        said_family: family of the first cause, `-` without one.
        gap_over_floor: the largest of the label's oracle; None for exact stages and healthy cases.
        single: one library effect and an answer asked for.
        detected: a gap was reported.
        stage, actuator, family, top1, in_set: the first place and the first cause are right.
        set_size: mean number of effects per cause, rivals included.
        recall, recall_in_sets, precision: of the named effects, for compounds too.
        closure_error: |stage closure - oracle's|.
        closure_inside: the oracle's closure lies in the stated interval.
        tip_error: the same error at the tip.
        parameters, parameters_inside: true parameters found by name, and those inside their interval.
        false_attribution: an effect was blamed where none of the library is to blame.
        rivals, experiment: the rivals of an under-excited case were named, an experiment was proposed.
        seconds: the verdict's own.
        stated: probabilities that the verdict states, of every cause and of a cause outside the library, and whether
            each was right.
    """

    case: str
    truth: str
    said: str
    fault: str
    answer: str
    families: str
    said_family: str
    gap_over_floor: float | None = None
    single: bool = False
    detected: bool | None = None
    stage: bool | None = None
    actuator: bool | None = None
    family: bool | None = None
    top1: bool | None = None
    in_set: bool | None = None
    set_size: float | None = None
    recall: float | None = None
    recall_in_sets: float | None = None
    precision: float | None = None
    closure_error: float | None = None
    closure_inside: bool | None = None
    tip_error: float | None = None
    parameters: int = 0
    parameters_inside: int = 0
    false_attribution: bool | None = None
    rivals: bool | None = None
    experiment: bool | None = None
    seconds: float | None = None
    stated: Sequence[tuple[float, bool]] = ()
    plant: str = "-"


def same_place(true: str, said: str | None) -> bool:
    """Whether a said actuator meets the true one: `all` and `tip` are met by any axis they reach."""
    if said is None:
        return False
    if true == said:
        return True
    if true == "all":
        return said in ACTUATORS or said == "tip"
    if true == "tip":
        return said in ACTUATORS or said == "all"
    return said == "tip" or (said == "all" and true in ACTUATORS)


def score_case(truth: Truth, verdict: Verdict | None) -> CaseScore:
    """Score one verdict; None counts as a miss wherever there is a gap."""
    given, status, effects = verdict or {}, truth["status"], truth["effects"]
    causes = given.get("causes") or []
    row = _names(truth, given, causes)
    if verdict is None and status == "no_gap":
        return CaseScore(**row)
    row["detected"] = verdict is not None and given.get("status") != "no_gap"
    if effects:
        row |= _place(effects, given.get("where") or [])
    known = [e for e in effects if e["family"] != "outside"]
    row["stated"] = _stated(truth, given, causes)
    if known:
        row |= _causes(known, causes)
        row |= _closure(truth, given)
    if status == "under_excited":
        row |= _abstention(truth, given, causes)
    if status in ("no_gap", "outside_library"):
        row["false_attribution"] = given.get("status") == "attributed"
    return CaseScore(**row)


def _names(truth: Truth, given: Verdict, causes: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return the columns that say what the case is and what the verdict named."""
    effects, status = truth["effects"], truth["status"]
    ratios = [o["gap_over_floor"] for o in (truth.get("oracle") or {}).values() if o.get("gap_over_floor")]
    return {
        "case": truth["case"],
        "plant": truth.get("plant", "-"),
        "truth": status,
        "said": given.get("status", "missing"),
        "fault": "+".join(e.get("fault", e["effect"]) for e in effects) or "-",
        "answer": "+".join(c["effect"] for c in causes) or "-",
        "families": "+".join(sorted({e["family"] for e in effects})) or "-",
        "said_family": causes[0]["family"] if causes else "-",
        "gap_over_floor": max(ratios) if ratios and effects else None,
        "single": status == "attributed" and len(effects) == 1,
        "seconds": given.get("seconds"),
    }


def _stated(truth: Truth, given: Verdict, causes: Sequence[Mapping[str, Any]]) -> list[tuple[float, bool]]:
    """Return the stated probabilities with whether they were right; a true effect's company is right too."""
    known = [e for e in truth["effects"] if e["family"] != "outside"]
    right = {e["effect"] for e in known} | {name for e in known for name in e["company"]}
    out = [(c["probability"], c["effect"] in right) for c in causes if c.get("probability") is not None]
    outside = _outside(given)
    if outside is not None:
        out.append((min(1.0, outside), truth["status"] == "outside_library"))
    return out


def _outside(given: Verdict) -> float | None:
    """Return the largest probability, over the places, of a cause outside the library; None where none is stated."""
    if not given.get("costs"):
        return (given.get("probabilities") or {}).get("outside_library")
    answers = [a for place in given.get("places") or [] for a in place["answers"]]
    return max((a["probability"] for a in answers if a.get("answer") == "outside_library"), default=0.0)


def _abstention(truth: Truth, given: Verdict, causes: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return whether the rivals of an under-excited case were named and an experiment proposed."""
    named = set().union(*map(_members, causes)) if causes else set()
    return {
        "rivals": len(named & set(truth.get("rivals") or [])) >= NAMED,
        "experiment": bool(given.get("next_experiment")),
    }


def _members(cause: Mapping[str, Any]) -> set[str]:
    return {cause["effect"], *(cause.get("rivals") or [])}


def _place(effects: Sequence[Mapping[str, Any]], where: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    first = where[0] if where else {}
    return {
        "stage": any(first.get("stage") in (e["stage"], *e["also"]) for e in effects),
        "actuator": any(same_place(e["actuator"], first.get("actuator")) for e in effects),
    }


def _causes(known: Sequence[Mapping[str, Any]], causes: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    true = {e["effect"] for e in known}
    named = [c["effect"] for c in causes]
    sets = [_members(c) for c in causes]
    company = set().union(*(set(e["company"]) for e in known))
    judged = [name for name in named if name in true or name not in company]
    found = [parameter_coverage(e, c) for e in known for c in causes if c["effect"] == e["effect"]]
    return {
        "top1": bool(named) and named[0] in true,
        "in_set": any(s & true for s in sets),
        "family": bool(causes) and causes[0]["family"] in {e["family"] for e in known},
        "set_size": sum(map(len, sets)) / len(sets) if sets else None,
        "recall": sum(e["effect"] in named for e in known) / len(known),
        "recall_in_sets": sum(any(e["effect"] in s for s in sets) for e in known) / len(known),
        "precision": sum(name in true for name in judged) / len(judged) if judged else None,
        "parameters": sum(n for n, _ in found),
        "parameters_inside": sum(hit for _, hit in found),
    }


def _number(x: Any) -> float | None:
    return float(x) if isinstance(x, (int, float)) and math.isfinite(x) else None


def _closure(truth: Truth, verdict: Verdict) -> dict[str, Any]:
    row: dict[str, Any] = {}
    stated = (verdict.get("closure") or {}).get("stage") or {}
    value = _number(stated.get("value"))
    able = [o for o in truth["oracle"].values() if o.get("closure") is not None]
    if able and value is not None:
        best = max(able, key=lambda o: o["gap_over_floor"] or math.inf)["closure"]
        low, high = _number(stated.get("low")), _number(stated.get("high"))
        row["closure_error"] = abs(value - best)
        row["closure_inside"] = None if low is None or high is None else low <= best <= high
    tip = _number(((verdict.get("closure") or {}).get("tip") or {}).get("value"))
    tips = [o["closure"] for o in (truth.get("tip") or {}).values() if o.get("closure") is not None]
    if tip is not None and tips:
        row["tip_error"] = min(abs(tip - best) for best in tips)
    return row
