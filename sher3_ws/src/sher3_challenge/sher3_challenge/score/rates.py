"""Rates over many scored cases, with their numbers and intervals, the confusions and the detectability curve.

A rate is None where no case counts for it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from sher3_common.numbers.shares import wilson

from sher3_challenge.score.case import CaseScore
from sher3_challenge.score.reliability import calibration_error

BINS = ((0.0, 1.5), (1.5, 2.0), (2.0, 3.0), (3.0, 5.0), (5.0, 12.0), (12.0, math.inf))
"""Bins of gap over floor for the detectability curve."""
CLOSE = 0.05
"""Error of a stated closure that counts as close; part of the name of its rate."""


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
    close = [s.closure_error <= CLOSE for s in kept if s.closure_error is not None]
    stated = [(p, right) for s in kept for p, right in s.stated]
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
        "calibration_error": Rate(calibration_error(stated) if stated else None, len(stated)),
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
