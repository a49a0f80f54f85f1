"""The odds in words: of the headline, and of every place for the page."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_diagnosis.verdict import Answer, Cause, Parameter, Place, Unexplained, Verdict
from sher3_diagnosis.words import listed, lower, place, quantity, range_text, share, words

SURE = 0.95
"""Probability from which the headline does not speak of odds. A convention of the words, as the next two."""
SPOKEN = 0.05
"""Probability from which an answer is spoken of."""
MOST = 3
"""Answers in a headline."""
SHARES = ("relative", "position_relative", "velocity_relative", "integral_relative", "fraction", "share")
"""Parameters without a unit that are shares of what the model has."""
LACKS = "something {0}that the library lacks"


def odds(verdict: Verdict) -> str:
    """Return the answers to the first place with their probabilities; empty where they need not be spoken of.

    They are where an effect is in play, and none is sure.
    """
    first = verdict.places[0] if verdict.places else None
    if first is None or first.bet is None or verdict.status not in ("attributed", "outside_library"):
        return ""
    one = verdict.one_answer
    ranked = [a for a in _spoken(first, verdict.status == "attributed") if a not in one[1:]]
    if ranked[0].probability >= SURE or not any(a.causes for a in ranked):
        return ""
    text = "; or ".join(_answer_text(a, first, i, one) for i, a in enumerate(ranked))
    named = {x for a in (first.bet, *one) for x in _names(a)}
    beside = [sized(c) for c in verdict.causes if (c.effect, c.actuator) not in named]
    return text + (f"; besides {listed(beside)}" if beside else "")


def name_of(cause: Cause) -> str:
    """Return effect and place of a cause, and the condition under which alone it acts."""
    only = f" ({cause.condition})" if cause.condition else ""
    return f"{lower(cause.effect)} on {place(cause.actuator)}{only}"


def _at(where: Place | Unexplained) -> str:
    """Return stage and place."""
    return f"{lower(where.stage)}, {place(where.actuator)}"


def _names(of: Answer) -> set[tuple[str, str]]:
    """Return effects and places of causes."""
    return {(c.effect, c.actuator) for c in of.causes}


def sized(cause: Cause) -> str:
    """Return a cause with the first of its parameters that differs from zero."""
    first = next((p for p in shown_parameters(cause).values() if significant(p)), None)
    return (
        name_of(cause)
        if first is None or first.unit == "1"
        else f"{name_of(cause)}, {first.means or quantity(first.value, first.unit)}"
    )


def shown_parameters(cause: Cause) -> dict[str, Parameter]:
    """Return the parameters of a cause without sizes that are exactly zero; shares in percent.

    Of parameters with one interval, the first.
    """
    out: dict[str, Parameter] = {}
    for name, p in cause.parameters.items():
        nothing = p.low is None and p.value == 0.0 and p.unit != "1"  # a friction that turns round at once
        if not nothing and (p.low is None or p not in out.values()):
            out[name] = p
    return {name: _in_percent(p) if p.unit == "1" and name in SHARES else p for name, p in out.items()}


def _in_percent(p: Parameter) -> Parameter:
    """Return a share in percent."""
    ends = (None if x is None else 100.0 * x for x in (p.low, p.high))
    return p.model_copy(update={"value": 100.0 * p.value, **dict(zip(("low", "high"), ends, strict=True)), "unit": "%"})


DECADES = 100.0
"""Largest over smallest size of an interval from which a value, known to a factor of ten at best, is not told."""


def parameter_text(parameter: Parameter) -> str:
    """Return a parameter in words, with its interval where it has one."""
    value = parameter.means or quantity(parameter.value, parameter.unit)
    if parameter.low is None:
        return value
    return f"{value} ({range_text(parameter.low, parameter.high, parameter.unit)})"


def significant(parameter: Parameter) -> bool:
    """Return whether a size is told: its interval holds no zero and spans less than two decades, or it has none."""
    if parameter.low is None or parameter.high is None:
        return True
    near, far = sorted((abs(parameter.low), abs(parameter.high)))
    return parameter.low * parameter.high > 0.0 and far < DECADES * near


def _spoken(first: Place, named: bool) -> list[Answer]:
    """Return the answers worth speaking of: where causes are named they come first, else the more probable."""
    ranked = sorted(first.answers, key=lambda a: (named and not a.causes, -round(a.probability, 2), not a.causes))
    return [a for a in ranked if a.probability >= SPOKEN or a is ranked[0]][:MOST]


def _answer_text(answer: Answer, first: Place, rank: int, one: Sequence[Answer]) -> str:
    """Return an answer with its probability and, of the best explanation and what is one with it, size and closure."""
    together = (one or [answer]) if answer is first.bet else [answer]
    likely = share(sum(a.probability for a in together))
    if answer.answer == "no_gap":
        return f"no gap, {likely}"
    if answer.answer is not None:
        where = f" in {_at(first)}" if not rank else ""
        return f"{LACKS.format('like it ' if rank else '')}{where}, {likely}"
    if answer is not first.bet:
        return f"{listed([name_of(c) for c in answer.causes])}, {likely}"
    closes = "" if answer.closure is None else f": closes {share(answer.closure.value)}"
    names = " or ".join(listed([sized(c) for c in a.causes]) for a in together)
    return f"{names}{' (the same data)' * (len(together) > 1)}, {likely}{closes}"


def answered(answer: Answer) -> str:
    """Return what an answer to a place says: its causes, or that there are none."""
    names = {"no_gap": "No gap", "outside_library": "Something that the library lacks"}
    return words(listed([name_of(c) for c in answer.causes], MOST)) if answer.causes else names[answer.answer or ""]


def sizes(answer: Answer) -> str:
    """Return the parameters of an answer's causes with their intervals, those whose size is told."""
    return ", ".join(
        f"{n.replace('_', ' ')} {parameter_text(p)}"
        for c in answer.causes
        for n, p in shown_parameters(c).items()
        if significant(p)
    )
