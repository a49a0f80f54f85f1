"""Scores of verdicts against sealed labels: one row per case, then rates with their numbers and intervals.

A rate is None where no case counts for it. Verdicts and labels are plain mappings (schemas `sher3.verdict/1` and
`sher3.truth/1`), so that verdicts of any program can be scored.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from sher3_description import ACTUATORS

from .intervals import parameter_coverage, wilson

Truth = Mapping[str, Any]
Verdict = Mapping[str, Any]

BINS = ((0.0, 1.5), (1.5, 2.0), (2.0, 3.0), (3.0, 5.0), (5.0, 12.0), (12.0, math.inf))
"""Bins of gap over floor for the detectability curve."""


@dataclass(frozen=True)
class CaseScore:
    """What one verdict got right; None where a question does not apply.

    Attributes:
        case: name.
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


@dataclass(frozen=True)
class Rate:
    """A mean over `n` cases with its 95 % Wilson interval (for shares) or None."""

    value: float | None
    n: int
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True)
class Summary:
    """All rates, the confusions and the detectability curve."""

    rates: dict[str, Rate]
    status_confusion: dict[str, dict[str, int]]
    family_confusion: dict[str, dict[str, int]]
    detectability: list[dict[str, float | int | str | None]] = field(default_factory=list)

    def as_dict(self) -> dict[str, Any]:
        """Return plain data for `--json`."""
        return asdict(self)


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
    given = verdict or {}
    effects = truth["effects"]
    causes = given.get("causes") or []
    ratios = [o["gap_over_floor"] for o in (truth.get("oracle") or {}).values() if o.get("gap_over_floor")]
    status = truth["status"]
    row: dict[str, Any] = {
        "case": truth["case"],
        "truth": status,
        "said": given.get("status", "missing") if verdict is not None else "missing",
        "fault": "+".join(e.get("fault", e["effect"]) for e in effects) or "-",
        "answer": "+".join(c["effect"] for c in causes) or "-",
        "families": "+".join(sorted({e["family"] for e in effects})) or "-",
        "said_family": causes[0]["family"] if causes else "-",
        "gap_over_floor": max(ratios) if ratios and effects else None,
        "single": status == "attributed" and len(effects) == 1,
        "seconds": given.get("seconds"),
    }
    if verdict is None and status == "no_gap":
        return CaseScore(**row)
    row["detected"] = verdict is not None and given.get("status") != "no_gap"
    if effects:
        row |= _place(effects, given.get("where") or [])
    known = [e for e in effects if e["family"] != "outside"]
    if known:
        row |= _causes(known, causes)
        row |= _closure(truth, given)
    if status == "under_excited":
        named = set().union(*map(_members, causes)) if causes else set()
        row["rivals"] = len(named & set(truth.get("rivals") or [])) >= 2
        row["experiment"] = bool(given.get("next_experiment"))
    if status in ("no_gap", "outside_library"):
        row["false_attribution"] = given.get("status") == "attributed"
    return CaseScore(**row)


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


Selector = Callable[[CaseScore], bool]


def rate(scores: Iterable[CaseScore], key: str, select: Selector = lambda s: True) -> Rate:
    """Return the mean of a column over the selected rows that have it."""
    values = [getattr(s, key) for s in scores if select(s) and getattr(s, key) is not None]
    if not values:
        return Rate(None, 0)
    share = sum(map(float, values)) / len(values)
    if isinstance(values[0], bool):
        return Rate(share, len(values), *wilson(share, len(values)))
    return Rate(share, len(values))


def summarise(scores: Sequence[CaseScore], *, least: float = 0.0) -> Summary:
    """Return the rates over cases whose gap over floor is at least `least`; exact stages always count."""
    kept = [s for s in scores if s.gap_over_floor is None or s.gap_over_floor >= least]
    status = _confusion((s.truth, s.said) for s in kept)
    family = _confusion((s.families, s.said_family) for s in kept if s.single)
    return Summary(_rates(kept), status, family, detectability(scores))


def _rates(kept: Sequence[CaseScore]) -> dict[str, Rate]:
    def gap(s: CaseScore) -> bool:
        return s.truth != "no_gap"

    def compound(s: CaseScore) -> bool:
        return s.truth == "attributed" and not s.single

    def of(truth: str) -> Selector:
        return lambda s: s.truth == truth

    def abstained(truth: str) -> Rate:
        rows = [s for s in kept if s.truth == truth and s.detected is not None]
        if not rows:
            return Rate(None, 0)
        share = sum(s.said == truth for s in rows) / len(rows)
        return Rate(share, len(rows), *wilson(share, len(rows)))

    answered = [s for s in kept if s.single]
    close = [s.closure_error <= 0.05 for s in kept if s.closure_error is not None]
    names, inside = sum(s.parameters for s in kept), sum(s.parameters_inside for s in kept)
    return {
        "detection": rate(kept, "detected", gap),
        "false_alarm": rate(kept, "detected", of("no_gap")),
        "stage": rate(kept, "stage", gap),
        "actuator": rate(kept, "actuator", gap),
        "family": rate(answered, "family"),
        "in_set": rate(answered, "in_set"),
        "set_size": rate(answered, "set_size"),
        "top1": rate(answered, "top1"),
        "precision": rate(answered, "precision"),
        "compound_recall": rate(kept, "recall", compound),
        "compound_recall_in_sets": rate(kept, "recall_in_sets", compound),
        "compound_precision": rate(kept, "precision", compound),
        "outside_abstention": abstained("outside_library"),
        "outside_false_attribution": rate(kept, "false_attribution", of("outside_library")),
        "healthy_false_attribution": rate(kept, "false_attribution", of("no_gap")),
        "under_excited_abstention": abstained("under_excited"),
        "under_excited_rivals": rate(kept, "rivals"),
        "closure_error": rate(kept, "closure_error"),
        "closure_within_0.05": Rate(sum(close) / len(close), len(close)) if close else Rate(None, 0),
        "closure_interval_coverage": rate(kept, "closure_inside"),
        "tip_closure_error": rate(kept, "tip_error"),
        "parameter_interval_coverage": Rate(inside / names if names else None, names),
        "seconds": rate(kept, "seconds"),
    }


def _confusion(pairs: Iterable[tuple[str, str]]) -> dict[str, dict[str, int]]:
    table: dict[str, dict[str, int]] = {}
    for true, said in pairs:
        row = table.setdefault(true, {})
        row[said] = row.get(said, 0) + 1
    return {true: dict(sorted(row.items())) for true, row in sorted(table.items())}


def detectability(scores: Sequence[CaseScore]) -> list[dict[str, float | int | str | None]]:
    """Return detected, top-1 and in-set shares of single faults by gap over floor; exact stages have their own row."""
    rows: list[dict[str, float | int | str | None]] = []
    single = [s for s in scores if s.single]
    groups = [("exact stage", [s for s in single if s.gap_over_floor is None])]
    for low, high in BINS:
        name = f"{low:g} to {high:g}" if math.isfinite(high) else f"over {low:g}"
        groups.append((name, [s for s in single if s.gap_over_floor is not None and low <= s.gap_over_floor < high]))
    for name, members in groups:
        if members:
            shares = {key: rate(members, key).value for key in ("detected", "family", "top1", "in_set")}
            rows.append({"gap_over_floor": name, "n": len(members), **shares})
    return rows
