"""The table of the plants left out: one column for each, judged by what was set on the others."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from sher3_common.numbers.shares import wilson

from sher3_challenge.calibration.held_out import Judgement
from sher3_challenge.score.rates import Rate
from sher3_challenge.score.reliability import calibration_error

CLEAR = 3.0
"""Gap over floor from which a case counts; exact stages always do."""
SURE = 0.95
"""Probability from which a cause is stated as good as certain, and an experiment has settled its odds."""
STATUSES = ("no_gap", "attributed", "under_excited", "outside_library")

Question = Callable[[Judgement], bool | None]


def clear(judgements: Sequence[Judgement]) -> list[Judgement]:
    """Return the judgements of healthy cases, exact stages and gaps of at least three floors."""
    return [j for j in judgements if (j.seen.ratio or CLEAR) >= CLEAR]


def small(judgements: Sequence[Judgement]) -> list[Judgement]:
    """Return the judgements of gaps of one to three floors."""
    return [j for j in judgements if 1.0 <= (j.seen.ratio or 0.0) < CLEAR]


def rates(judgements: Sequence[Judgement], counted: Callable[..., list[Judgement]] = clear) -> dict[str, Rate]:
    """Return the rates of one plant over the cases that are counted; probabilities are those of all."""
    kept = counted(judgements)
    whole = [j for j in kept if not j.seen.without]
    shares = {s: _share(whole, s, lambda j: j.said == j.seen.truth["status"]) for s in STATUSES}
    seen = [r.value for r in shares.values() if r.value is not None]
    withheld = [j for j in kept if j.seen.without and not j.excused]
    stated = [r for j in judgements for r in j.right]
    sure = [right for j in judgements for p, right in j.causes if p >= SURE]
    return {
        "balanced": Rate(sum(seen) / len(seen) if seen else None, len(whole)),
        **{f"said {s}": r for s, r in shares.items()},
        "rightly named, called outside": _rate([j.said == "outside_library" for j in whole if j.rightly_named]),
        "outside blamed": _share(whole, "outside_library", lambda j: j.said == "attributed"),
        "withheld abstained": _rate([j.said == "outside_library" for j in withheld]),
        "withheld blamed": _rate([j.said in ("attributed", "under_excited") for j in withheld]),
        "withheld, same data": Rate(None, sum(j.excused for j in kept)),
        "top1": _rate([j.first_right for j in whole if j.first_right is not None]),
        "in the set": _rate([j.in_set for j in whole if j.in_set is not None]),
        "set size": _mean([j.set_size for j in whole if j.set_size is not None]),
        "right of the sure": _rate(sure),
        "calibration error": Rate(calibration_error(stated) if stated else None, len(stated)),
    }


def _share(judgements: Sequence[Judgement], status: str, ask: Question) -> Rate:
    return _rate([ask(j) for j in judgements if j.seen.truth["status"] == status])


def _rate(answers: Sequence[bool | None]) -> Rate:
    known = [bool(a) for a in answers if a is not None]
    if not known:
        return Rate(None, 0)
    share = sum(known) / len(known)
    return Rate(share, len(known), *wilson(share, len(known)))


def _mean(values: Sequence[float]) -> Rate:
    return Rate(sum(values) / len(values), len(values)) if values else Rate(None, 0)


@dataclass(frozen=True)
class Target:
    """What a rate is held to."""

    sign: str
    limit: float


TARGETS = {
    "balanced": Target(">=", 0.90),
    "rightly named, called outside": Target("<=", 0.03),
    "said outside_library": Target(">=", 0.90),
    "outside blamed": Target("<=", 0.03),
    "withheld abstained": Target(">=", 0.85),
    "withheld blamed": Target("<=", 0.05),
    "said no_gap": Target(">=", 1.0),
    "top1": Target(">=", 0.93),
    "in the set": Target(">=", 0.97),
    "set size": Target("<=", 1.3),
    "right of the sure": Target(">=", 0.93),
    "calibration error": Target("<=", 0.05),
}


def written(columns: dict[str, dict[str, Rate]]) -> str:
    """Return the table in Markdown, one column per plant left out."""
    names = list(columns)
    lines = [f"| rate | target | {' | '.join(names)} |", "|---" * (len(names) + 2) + "|"]
    for rate in next(iter(columns.values())):
        target = TARGETS.get(rate)
        aim = f"{target.sign} {target.limit:g}" if target else ""
        lines.append(f"| {rate} | {aim} | {' | '.join(_cell(columns[n][rate]) for n in names)} |")
    return "\n".join(lines)


def _cell(rate: Rate) -> str:
    if rate.value is None:
        return f"n {rate.n}" if rate.n else "-"
    interval = "" if rate.low is None else f" [{rate.low:.2f}, {rate.high:.2f}]"
    return f"{rate.value:.2f}{interval} (n {rate.n})"
