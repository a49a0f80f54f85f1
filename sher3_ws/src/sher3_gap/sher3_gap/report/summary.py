"""The answer in words: one headline and five lines, for the terminal and the top of the report."""

from __future__ import annotations

from sher3_gap.apply import PLACES
from sher3_gap.report.style import STAGE_NAMES, place, quantity, range_text, ratio_text, share, words
from sher3_gap.verdict import Cause, Interval, Verdict

STATUS = {
    "no_gap": "No gap: the robot does what the nominal model says, to within its own repeatability.",
    "attributed": "The gap is explained.",
    "under_excited": "A gap is there, but these runs cannot tell its cause from a rival of another family.",
    "outside_library": "A gap is there that no effect of the library explains.",
}


def headline(verdict: Verdict) -> str:
    """Return the verdict's status as one sentence."""
    return STATUS[verdict.status]


def five_lines(verdict: Verdict) -> list[tuple[str, str]]:
    """Return (label, text) of the five lines: verdict, where, cause, closure, next."""
    return [
        ("verdict", f"{verdict.status}: {headline(verdict)}"),
        ("where", _where(verdict)),
        ("cause", "; ".join(cause_text(c) for c in verdict.causes) or _unknown(verdict)),
        ("closure", _closure(verdict)),
        ("next", _next(verdict)),
    ]


def cause_text(cause: Cause) -> str:
    """Return a cause with its first parameter and its rivals."""
    text = f"{words(cause.effect)} on {place(cause.actuator)}"
    if cause.parameters:
        name, p = next(iter(cause.parameters.items()))
        text += f", {name.replace('_', ' ')} {quantity(p.value, p.unit)}"
        if p.low is not None:
            text += f" ({range_text(p.low, p.high, p.unit)})"
    return text + (f" [or {', '.join(words(r).lower() for r in cause.rivals)}]" if cause.rivals else "")


def _where(verdict: Verdict) -> str:
    if not verdict.where:
        return "every recorded stage is at its floor"
    first = verdict.where[0]
    ratio = ratio_text(first.gap / first.floor) if first.floor > 0 else "≫ 1000"
    text = f"{STAGE_NAMES[first.stage].lower()}, {place(first.actuator)}: {quantity(first.gap, first.unit)} rms, "
    text += f"{ratio} times the floor, {first.regime}"
    more = len(verdict.where) - 1
    return text + (f" (and {more} more place{'s' * (more > 1)})" if more else "")


def _unknown(verdict: Verdict) -> str:
    if verdict.unexplained is None:
        return "none needed"
    return f"none of the library; what is left: {verdict.unexplained.signature}"


def _closure(verdict: Verdict) -> str:
    parts = []
    for name, value in (("stage", verdict.closure.stage), ("tip", verdict.closure.tip)):
        if value is not None:
            parts.append(f"{name} {closure_text(value)}")
    if verdict.residual is not None and verdict.causes:
        r = verdict.residual
        parts.append(f"left {quantity(r.gap, r.unit)} over a floor of {quantity(r.floor, r.unit)}")
    return ", ".join(parts) or "nothing to close"


def closure_text(value: Interval) -> str:
    """Return a closure with its interval."""
    if value.low is None:
        return share(value.value)
    return f"{share(value.value)} ({share(value.low)} … {share(value.high)})"


def _next(verdict: Verdict) -> str:
    if verdict.next_experiment is not None:
        e = verdict.next_experiment
        rivals = " / ".join(words(i).lower() for i in e.separates)
        return f"`sher3 gap experiment verdict.json`: {e.excitation} tells {rivals} apart"
    if any(c.actuator not in PLACES for c in verdict.causes):
        return "put the parameters into this machine's own simulator"
    if verdict.causes:
        return "`sher3 gap apply verdict.json` puts the causes into the simulator"
    if verdict.unexplained is not None:
        return "a sensor nearer to that place, or an effect of your own: the signature says what it must do"
    return "none"
