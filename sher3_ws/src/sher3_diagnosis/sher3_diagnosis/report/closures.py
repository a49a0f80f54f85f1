"""Closure bars: how much of the gap each cause closes on held-out runs, with 95 % intervals."""

from __future__ import annotations

from dataclasses import dataclass

from sher3_diagnosis.verdict import Interval, Verdict
from sher3_diagnosis.words import place, share, words


@dataclass(frozen=True)
class Bar:
    """One closure as a bar; lengths in percent of the whole gap.

    Attributes:
        name: of the cause, or of all together.
        text: the closure in words.
        value, low, high: of the bar and of its interval; the interval is None where too few runs carry one.
        together: whether it is of all causes.
    """

    name: str
    text: str
    value: float
    low: float | None
    high: float | None
    together: bool


def closure_bars(verdict: Verdict, end: str) -> list[Bar]:
    """Return the bars, none where nothing was closed; `end` names where the whole machine is judged."""
    bars = [_bar(f"{words(c.effect)}, {place(c.actuator)}", c.closure, False) for c in verdict.causes]
    together = (("at the first place", verdict.closure.stage), (end, verdict.closure.tip)) if bars else ()
    return bars + [_bar(f"all causes, {name}", value, True) for name, value in together if value is not None]


def _bar(name: str, closure: Interval, together: bool) -> Bar:
    value, low, high = (None if x is None else 100.0 * max(x, 0.0) for x in (closure.value, closure.low, closure.high))
    return Bar(name, share(closure.value), value or 0.0, low, high, together)
