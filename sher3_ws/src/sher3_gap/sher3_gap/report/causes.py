"""The causes: what they are in plain words, their parameters, and why rivals were or were not ruled out."""

from __future__ import annotations

from dataclasses import dataclass

from sher3_gap.attribute import PRICE, RIVAL, Attribution
from sher3_gap.diagnose import Diagnosis
from sher3_gap.library import LIBRARY
from sher3_gap.pattern import Pattern, pattern_of
from sher3_gap.report.style import STAGE_NAMES, place, quantity, range_text, share, words
from sher3_gap.structure import Structure
from sher3_gap.verdict import Cause


@dataclass(frozen=True)
class RivalRow:
    """One effect in place of the cause."""

    name: str
    site: str
    behind: str
    verdict: str
    separator: str
    kept: bool


@dataclass(frozen=True)
class CauseCard:
    """Everything the report says of one cause."""

    title: str
    family: str
    stage: str
    explanation: str
    closure: str
    interval: str
    parameters: list[tuple[str, str, str]]
    rivals: list[RivalRow]
    margin: str
    alike: list[str]
    pattern: str = ""


def cause_cards(diagnosis: Diagnosis, structure: Structure) -> list[CauseCard]:
    """Return one card per cause of the verdict."""
    return [_card(c, diagnosis, structure) for c in diagnosis.verdict.causes]


def _card(cause: Cause, diagnosis: Diagnosis, structure: Structure) -> CauseCard:
    attribution = diagnosis.attribution
    index = next((i for i, t in enumerate(attribution.fit.terms) if t.key == (cause.effect, cause.actuator)), None)
    rows, margin = ([], 0.0) if index is None else _rivals(cause, attribution, index)
    parameters = [
        (name.replace("_", " "), quantity(p.value, p.unit), range_text(p.low, p.high, p.unit))
        for name, p in cause.parameters.items()
    ]
    group = structure.group_of(cause.effect)
    return CauseCard(
        f"{words(cause.effect)} on {place(cause.actuator)}",
        words(cause.family),
        STAGE_NAMES.get(cause.stage, cause.stage),
        LIBRARY[cause.effect].explanation,
        share(cause.closure.value),
        "interval: too few runs" if cause.closure.low is None else _interval(cause),
        parameters,
        rows,
        f"{margin:.0f}",
        sorted(words(e) for e in group - {cause.effect}),
        "" if index is None else pattern_text(pattern_of(diagnosis.evidence, attribution.fit, index)),
    )


def pattern_text(found: Pattern) -> str:
    """Return whether the gap lives where the cause says it does, in a sentence; empty when no regimes can tell."""
    worst = found.worst
    if worst is None:
        return ""
    text = (
        f"What it takes off lies where it predicts to {share(found.agreement)} over speed, direction, position, load "
    )
    text += f"and runs. It differs most {worst.regime}: {share(worst.predicted)} predicted, {share(worst.realised)} "
    return text + "of the reduction on held-out runs."


def _interval(cause: Cause) -> str:
    return f"95 %: {share(cause.closure.low)} … {share(cause.closure.high)}"


def _rivals(cause: Cause, attribution: Attribution, index: int) -> tuple[list[RivalRow], float]:
    """Return the effects that come closest in the cause's place, and the margin within which they count as rivals."""
    margin = max(3.0 * PRICE, RIVAL * attribution.explained[index])
    kept = {f.terms[-1].key for f in attribution.rivals[index]}
    ranked = {f.terms[-1].key: f for f in (*attribution.ranking[index], *attribution.rivals[index])}
    rows = []
    for (effect, site), trial in sorted(ranked.items(), key=lambda item: item[1].total):
        if (effect, site) == (cause.effect, cause.actuator):
            continue
        behind = trial.total - attribution.fit.total
        worse = 100.0 * behind / max(attribution.explained[index], 1e-9)
        verdict = "not told apart" if (effect, site) in kept else "ruled out"
        separator = separates(cause.effect, effect)
        rows.append(RivalRow(words(effect), place(site), f"{worse:.1f} %", verdict, separator, verdict != "ruled out"))
    return rows, margin


def separates(cause: str, rival: str) -> str:
    """Return what tells a rival from a cause, from either side's siblings; empty when the library does not say."""
    if rival in LIBRARY[cause].siblings:
        return f"{words(rival)}: {LIBRARY[cause].siblings[rival]}"
    if cause in LIBRARY[rival].siblings:
        return f"{words(cause)}: {LIBRARY[rival].siblings[cause]}"
    if LIBRARY[cause].stage != LIBRARY[rival].stage:
        return f"shows at another stage ({STAGE_NAMES[LIBRARY[rival].stage].lower()})"
    return ""
