"""The answer in words: one headline and five lines, for the terminal and the top of the report."""

from __future__ import annotations

from sher3_diagnosis.report.words import listed, place, quantity, range_text, ratio_text, share, words
from sher3_diagnosis.verdict import Cause, Interval, Verdict


def headline(verdict: Verdict) -> str:
    """Return the answer as one sentence."""
    names = [_name(c) for c in verdict.causes]
    if verdict.status == "no_gap":
        return "No gap: the machine does what its model says, to within its own repeatability."
    if verdict.status == "attributed":
        return _sentence(f"{listed(names)} explain{'s' * (len(names) == 1)} the gap.")
    if verdict.status == "under_excited":
        open_ones = [f"{_name(c)} or {listed([_lower(r) for r in c.rivals])}" for c in verdict.causes if c.rivals]
        return _sentence(f"{listed(open_ones or names)}: these runs cannot tell.")
    left = verdict.unexplained
    where = "" if left is None else f" in {_lower(left.stage)}, {place(left.actuator)}"
    return f"No effect of the library explains the gap{where}."


def five_lines(verdict: Verdict, simulated: bool) -> list[tuple[str, str]]:
    """Return (label, text) of the five lines: verdict, where, cause, closure, next.

    Args:
        verdict: of any machine.
        simulated: whether `sher3 gap apply` and `sher3 gap experiment` know the machine's simulator.
    """
    return [
        ("verdict", f"{verdict.status}: {headline(verdict)}"),
        ("where", _where(verdict)),
        ("cause", "; ".join(cause_text(c) for c in verdict.causes) or _unknown(verdict)),
        ("closure", _closure(verdict)),
        ("next", _next(verdict, simulated)),
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


def closure_text(value: Interval) -> str:
    """Return a closure with its interval."""
    if value.low is None:
        return share(value.value)
    return f"{share(value.value)} ({share(value.low)} … {share(value.high)})"


NAMES_OF_PEOPLE = ("coulomb", "stribeck")
"""First words of effects that keep their capital inside a sentence."""


def _lower(identifier: str) -> str:
    text = words(identifier)
    return text if text.lower().startswith(NAMES_OF_PEOPLE) else text[:1].lower() + text[1:]


def _name(cause: Cause) -> str:
    return f"{_lower(cause.effect)} on {place(cause.actuator)}"


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]


def _where(verdict: Verdict) -> str:
    if not verdict.where:
        return "every recorded stage is at its floor"
    first = verdict.where[0]
    ratio = ratio_text(first.gap / first.floor) if first.floor > 0 else "≫ 1000"
    text = f"{words(first.stage).lower()}, {place(first.actuator)}: {quantity(first.gap, first.unit)} rms, "
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


def _next(verdict: Verdict, simulated: bool) -> str:
    if verdict.next_experiment is not None:
        e = verdict.next_experiment
        tells = f"{e.excitation} tells {' / '.join(words(i).lower() for i in e.separates)} apart"
        return f"`sher3 gap experiment verdict.json`: {tells}" if simulated else tells
    if verdict.causes:
        if simulated:
            return "`sher3 gap apply verdict.json` puts the causes into the simulator"
        return "put the parameters into this machine's own simulator"
    if verdict.unexplained is not None:
        return "a sensor nearer to that place, or an effect of your own: the signature says what it must do"
    return "none"
