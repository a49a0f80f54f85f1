"""What is worse than the baseline: a new cause or place, a cause that grew beyond its interval, a higher floor."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal, NamedTuple

from sher3_diagnosis.report.summary import cause_text, shown_parameters
from sher3_diagnosis.verdict import Cause, Interval, Verdict
from sher3_diagnosis.words import place, quantity, words

from sher3_public.guard.baseline import Entry

ALLOWED = 0.2
"""Share by which a size or a floor may rise before it counts, unless the caller says another. A convention."""
Rule = Literal["new cause", "new place", "growth", "floor"]
RULES: dict[Rule, str] = {
    "new cause": "a cause that the baseline neither names nor holds for a rival",
    "new place": "a gap at a place where the baseline has none, and no cause there",
    "growth": "a cause whose whole interval lies beyond the baseline's",
    "floor": "a floor above the baseline's, which hides gaps",
}
"""What is looked for."""


class Worse(NamedTuple):
    """One thing that is worse than it was."""

    rule: Rule
    actuator: str
    text: str


def worse(baseline: Entry, now: Entry, allowed: float = ALLOWED) -> list[Worse]:
    """Return what is worse than the baseline; nothing where the answer is as good or better.

    Args:
        baseline: what was said when it was good.
        now: what is said.
        allowed: share by which a size or a floor may rise.
    """
    new = [c for c in now.verdict.causes if _same(baseline.verdict, c) is None]
    return [
        *(Worse("new cause", c.actuator, cause_text(c)) for c in new),
        *_places(baseline.verdict, now.verdict),
        *_growths(baseline.verdict, now.verdict, allowed),
        *_floors(baseline, now, allowed),
    ]


def _same(baseline: Verdict, cause: Cause) -> Cause | None:
    """Return the cause of the baseline that a cause is, or that could not be told from it."""
    here = [c for c in baseline.causes if (c.actuator, c.condition) == (cause.actuator, cause.condition)]
    alike = [c for c in here if cause.effect in (c.effect, *c.rivals) or c.effect in cause.rivals]
    return next((c for c in alike if c.effect == cause.effect), alike[0] if alike else None)


def _places(baseline: Verdict, now: Verdict) -> Iterator[Worse]:
    known = {(w.stage, w.actuator) for w in baseline.where} | {(c.stage, c.actuator) for c in now.causes}
    for w in now.where:
        if (w.stage, w.actuator) not in known:
            text = f"{words(w.stage).lower()}, {place(w.actuator)}: {quantity(w.gap, w.unit)} rms without a cause"
            yield Worse("new place", w.actuator, text)


def _growths(baseline: Verdict, now: Verdict, allowed: float) -> Iterator[Worse]:
    for cause in now.causes:
        before = _same(baseline, cause)
        if before is None or before.effect != cause.effect:
            continue
        for name, value in shown_parameters(cause).items():
            was = shown_parameters(before).get(name)
            if was is not None and was.unit == value.unit and least(value) > (1.0 + allowed) * most(was) > 0.0:
                sizes = f"{quantity(was.value, was.unit)} -> {quantity(value.value, value.unit)}"
                yield Worse(
                    "growth", cause.actuator, f"{words(cause.effect)} on {place(cause.actuator)}, {name}: {sizes}"
                )


def _floors(baseline: Entry, now: Entry, allowed: float) -> Iterator[Worse]:
    for name, floor in now.floors.items():
        was = baseline.floors.get(name)
        if was is not None and was.unit == floor.unit and floor.value > (1.0 + allowed) * was.value:
            stage, actuator = name.split("/")
            sizes = f"{quantity(was.value, was.unit)} -> {quantity(floor.value, floor.unit)} rms"
            yield Worse("floor", actuator, f"{words(stage).lower()}, {place(actuator)}: {sizes}")


def least(x: Interval) -> float:
    """Return the smallest magnitude that an interval holds; that of the value where there is no interval."""
    if x.low is None or x.high is None:
        return abs(x.value)
    return 0.0 if x.low <= 0.0 <= x.high else min(abs(x.low), abs(x.high))


def most(x: Interval) -> float:
    """Return the largest magnitude that an interval holds."""
    return max(abs(v) for v in (x.value, x.low, x.high) if v is not None)
