"""The causes: what they are in plain words, their parameters, and why rivals were or were not ruled out."""

from __future__ import annotations

from typing import NamedTuple

from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.finding import Finding
from sher3_diagnosis.localise.pattern import Pattern, pattern_of
from sher3_diagnosis.machine import Diagnosis
from sher3_diagnosis.report.odds import significant
from sher3_diagnosis.report.summary import shown_parameters
from sher3_diagnosis.verdict import Cause, Parameter
from sher3_diagnosis.words import listed, lower, place, quantity, range_text, share, words

NO_LOSS = 1e-9
"""Explained loss below which a share of it means nothing."""


class RivalRow(NamedTuple):
    """One effect in place of the cause.

    Attributes:
        name, site: which effect, and where.
        behind: share of the explained loss that it explains less.
        kept: whether it was not told apart.
        separator: what tells the two apart.
    """

    name: str
    site: str
    behind: str
    kept: bool
    separator: str


class CauseCard(NamedTuple):
    """What the report says of a cause beside the verdict.

    Attributes:
        cause: of the verdict.
        explanation: plain language: what the effect is and how it shows.
        parameters: (name, value, interval) each.
        rivals: effects that come closest in its place, best first; None where none was tried.
        pattern: whether the gap lives where the cause says it does; empty when no regimes can tell.
    """

    cause: Cause
    explanation: str
    parameters: list[tuple[str, str, str]]
    rivals: list[RivalRow] | None
    pattern: str


def cause_cards(diagnosis: Diagnosis) -> list[CauseCard]:
    """Return one card per cause of the verdict."""
    library = {e.id: e for e in diagnosis.machine.library()}
    return [_card(c, diagnosis, library.get(c.effect)) for c in diagnosis.verdict.causes]


def _card(cause: Cause, diagnosis: Diagnosis, effect: Effect | None) -> CauseCard:
    fitted = _term_of(cause, diagnosis)
    rivals, pattern = None, ""
    if fitted is not None:
        finding, index = fitted
        effect = finding.attribution.fit.terms[index].effect
        rivals = _rivals(cause, finding.attribution, index) if finding.attribution.ranking else None
        pattern = pattern_text(pattern_of(finding.evidence, finding.attribution.fit, index))
    if effect is None:
        return CauseCard(cause, "", _parameters(cause, frozenset()), rivals, pattern)
    return CauseCard(cause, effect.explanation, _parameters(cause, effect.discrete), rivals, pattern)


def _parameters(cause: Cause, choices: frozenset[str]) -> list[tuple[str, str, str]]:
    """Return (name, value, interval) in words, those that differ from zero first."""
    ranked = sorted(shown_parameters(cause).items(), key=lambda x: not significant(x[1]))
    return [(n.replace("_", " "), p.means or quantity(p.value, p.unit), _interval(p, n in choices)) for n, p in ranked]


def _interval(p: Parameter, choice: bool) -> str:
    """Return a parameter's interval, and whether it holds zero; of a choice that it is one."""
    if choice:
        return "a choice"
    if p.means and p.low is None:
        return ""
    return range_text(p.low, p.high, p.unit) + ("" if significant(p) else ", size not told")


def _term_of(cause: Cause, diagnosis: Diagnosis) -> tuple[Finding, int] | None:
    """Return the finding and the index of the term a cause came from; None for a cause of an exact stage."""
    for finding in diagnosis.findings:
        for index in finding.attribution.causes:
            if finding.attribution.fit.terms[index].key == (cause.effect, cause.actuator):
                return finding, index
    return None


def pattern_text(found: Pattern) -> str:
    """Return whether the gap lives where the cause says it does, in a sentence; empty when no regimes can tell."""
    worst = found.worst
    if worst is None:
        return ""
    return (
        f"The gap shrinks where this law says: they agree to {share(found.agreement)}, and least {worst.regime}, where "
        f"{share(worst.predicted)} of the reduction was expected and {share(worst.realised)} was seen on held-out data."
    )


def _rivals(cause: Cause, attribution: Attribution, index: int) -> list[RivalRow]:
    """Return the effects that come closest in the cause's place, best first."""
    kept = {f.terms[-1].key for f in attribution.rivals[index]}
    ranked = {f.terms[-1].key: f for f in (*attribution.ranking[index], *attribution.rivals[index])}
    chosen, worth = attribution.fit.terms[index].effect, max(attribution.explained[index], NO_LOSS)
    rows = []
    for key, trial in sorted(ranked.items(), key=lambda item: item[1].total):
        if key == (cause.effect, cause.actuator):
            continue
        rival = trial.terms[-1]
        behind = (trial.total - attribution.fit.total) / worth
        separator = separates(chosen, rival.effect)
        less = "all of it" if behind >= 1.0 else f"{100.0 * behind:.1f} %" if behind > 0.0 else "nothing"
        open_one = key in kept or behind <= 0.0
        rows.append(RivalRow(words(rival.effect.id), place(rival.site), less, open_one, separator))
    return rows


def separates(cause: Effect, rival: Effect) -> str:
    """Return what tells a rival from a cause: from either side's siblings, else stage, inputs or shape of the laws."""
    if rival.id in cause.siblings:
        return f"{words(rival.id)}: {cause.siblings[rival.id]}"
    if cause.id in rival.siblings:
        return f"{words(cause.id)}: {rival.siblings[cause.id]}"
    if cause.stage != rival.stage:
        return f"shows at another stage ({words(rival.stage).lower()})"
    if rival.id == cause.id:
        return "the same effect at another place: its own axis moves it"
    if set(rival.inputs) != set(cause.inputs):
        return f"{words(rival.id)} depends on {_inputs(rival)}, {lower(cause.id)} on {_inputs(cause)}"
    return f"the same inputs, another law: `{rival.best.excitation}`, since {rival.best.why}"


def _inputs(effect: Effect) -> str:
    """Return what the law of an effect depends on."""
    return listed(list(effect.inputs), len(effect.inputs)) if effect.inputs else "nothing"
