"""A verdict as if its best bets were named: for whoever would rather act on odds than wait."""

from __future__ import annotations

from sher3_common.errors import Sher3Error

from sher3_diagnosis.verdict import Answer, Cause, Closure, Place, Verdict
from sher3_diagnosis.words import listed, lower, place, share


class NoBetError(Sher3Error):
    """A verdict lists nothing that could be bet on."""


def bets(verdict: Verdict) -> list[tuple[Place, Answer]]:
    """Return places with their best explanations; none where a place is most likely no gap."""
    likely = [p for p in verdict.places if p.answers[0].answer != "no_gap"]
    return [(p, p.bet) for p in likely if p.bet is not None]


def betting(verdict: Verdict) -> Verdict:
    """Return the verdict with the best explanation of every place as its causes, whatever its status.

    A cause without rivals of its own has those effects as rivals that its place lists besides.

    Raises:
        NoBetError: no place has an explanation.
    """
    chosen = bets(verdict)
    if not chosen:
        remedy = "diagnose the case again" if not verdict.places else "look for a formula: `sher3 gap discover CASE`"
        raise NoBetError(f"a verdict {verdict.status!r} lists no effect to bet on", remedy=remedy)
    causes: dict[tuple[str, str], Cause] = {}
    for where, bet in chosen:
        for cause in bet.causes:
            causes.setdefault((cause.effect, cause.actuator), _with_rivals(cause, where))
    return verdict.model_copy(
        update={
            "status": "attributed",
            "causes": list(causes.values()),
            "closure": Closure(stage=chosen[0][1].closure),
            "residual": chosen[0][1].residual,
            "unexplained": None,
        }
    )


def bets_text(verdict: Verdict) -> list[str]:
    """Return one line per place: what is bet on, and its odds."""
    lines = []
    for where, bet in bets(verdict):
        names = listed([f"{lower(c.effect)} on {place(c.actuator)}" for c in bet.causes])
        closes = "" if bet.closure is None else f", closes {share(bet.closure.value)}"
        lines.append(f"{lower(where.stage)}, {place(where.actuator)}: {names}, {share(bet.probability)}{closes}")
    return lines


def _with_rivals(cause: Cause, where: Place) -> Cause:
    others = [c.effect for a in where.answers if a is not where.bet for c in a.causes]
    own = {c.effect for c in where.bet.causes} if where.bet else set()
    rivals = [e for e in dict.fromkeys(others) if e not in own]
    return cause if cause.rivals else cause.model_copy(update={"rivals": rivals})
