"""The proposed next experiment: what to run, why, and how far these runs separate the rivals."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sher3_diagnosis.reporter import Reporter
from sher3_diagnosis.verdict import Verdict
from sher3_diagnosis.words import share, words


@dataclass(frozen=True)
class ExperimentCard:
    """The experiment as the report shows it.

    Attributes:
        title: name of the excitation.
        about: what that excitation is for; empty when the machine does not say.
        why: it separates these rivals.
        separates: their names.
        separation: by how many floors they are expected to differ; empty when that was not foretold.
        odds: expected of the effect that is at work; empty likewise.
    """

    title: str
    about: str
    why: str
    separates: str
    separation: str
    odds: str


def experiment_card(verdict: Verdict, reporter: Reporter) -> ExperimentCard | None:
    """Return the card, or None when nothing needs to be told apart."""
    proposed = verdict.next_experiment
    if proposed is None:
        return None
    known = proposed.predicted_separation
    return ExperimentCard(
        title=f"{proposed.excitation} with {proposed.added}" if proposed.added else proposed.excitation,
        about=reporter.purpose(proposed.excitation),
        why=proposed.purpose,
        separates=" / ".join(words(e) for e in proposed.separates),
        separation="" if known is None else f"{math.sqrt(known):.2g}",
        odds="" if proposed.expected_odds is None else share(proposed.expected_odds),
    )
