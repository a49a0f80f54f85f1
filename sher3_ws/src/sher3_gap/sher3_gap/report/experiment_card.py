"""The proposed next experiment: what to run, why, and how far it is expected to separate the rivals."""

from __future__ import annotations

from dataclasses import dataclass

from sher3_gap.excitation import catalogue
from sher3_gap.report.style import words
from sher3_gap.verdict import Verdict


@dataclass(frozen=True)
class ExperimentCard:
    """The experiment as the report shows it."""

    title: str
    purpose: str
    separates: str
    separation: str
    expected: str


def experiment_card(verdict: Verdict) -> ExperimentCard | None:
    """Return the card, or None when nothing needs to be told apart."""
    proposed = verdict.next_experiment
    if proposed is None:
        return None
    entry = catalogue().get(proposed.excitation.split("_")[0])
    separation = "–" if proposed.predicted_separation is None else f"{proposed.predicted_separation:.2g}"
    return ExperimentCard(
        proposed.excitation,
        proposed.purpose,
        " / ".join(words(e) for e in proposed.separates),
        separation,
        entry.purpose if entry else "",
    )
