"""The outcome of a challenge: scores of the diagnosis and of every baseline over the same cases."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sher3_common import FileError, read_json

from sher3_challenge.errors import ChallengeError
from sher3_challenge.score.case import CaseScore
from sher3_challenge.score.rates import Summary, summarise

SCORES = "scores.json"
MAX_SCORES_BYTES = 64 << 20
CLEAR = 3.0
"""Gap over floor from which targets hold."""


@dataclass(frozen=True)
class Outcome:
    """Scores of the diagnosis and of every baseline over the same cases, and errors by case."""

    scores: dict[str, list[CaseScore]]
    seconds: float
    seeds: tuple[int, int]
    errors: dict[str, str]

    @property
    def plants(self) -> tuple[str, ...]:
        """Return the names of the truth plants of the cases, sorted."""
        return tuple(sorted({s.plant for s in self.scores["diagnosis"]}))

    def summary(self, who: str = "diagnosis", *, least: float = 0.0, plant: str | None = None) -> Summary:
        """Return the summary of one competitor over cases with a gap over floor of at least `least`, of one plant."""
        return summarise([s for s in self.scores[who] if plant in (None, s.plant)], least=least)

    def as_dict(self) -> dict[str, Any]:
        """Return plain data for `--json`."""
        return {
            "seeds": list(self.seeds),
            "seconds": self.seconds,
            "errors": self.errors,
            "all": {who: self.summary(who).as_dict() for who in self.scores},
            "from_3": {who: self.summary(who, least=CLEAR).as_dict() for who in self.scores},
            "by_plant": {name: self.summary(least=CLEAR, plant=name).as_dict() for name in self.plants},
            "cases": {who: [s.__dict__ for s in rows] for who, rows in self.scores.items()},
        }


def merged(folders: Sequence[Path]) -> Outcome:
    """Return the outcome over finished challenges, whose seeds must not overlap on one plant.

    Raises:
        ChallengeError: a folder without scores, or a case in two of them.
    """
    scores: dict[str, list[CaseScore]] = {}
    seconds = 0.0
    seeds: list[int] = []
    errors: dict[str, str] = {}
    for folder in folders:
        try:
            kept = read_json(folder / SCORES, MAX_SCORES_BYTES)
            for who, rows in kept["cases"].items():
                scores.setdefault(who, []).extend(CaseScore(**row) for row in rows)
            seconds, errors, seeds = seconds + kept["seconds"], errors | kept["errors"], seeds + kept["seeds"]
        except (FileError, KeyError, TypeError, AttributeError) as error:
            raise ChallengeError("no scores", value=str(folder), remedy="a folder that --out wrote") from error
    names = [f"{s.plant} {s.case}" for s in scores.get("diagnosis", [])]
    if len(set(names)) < len(names):
        twice = max(names, key=names.count)
        raise ChallengeError("a case is in two folders", value=twice, remedy="give each folder seeds of its own")
    return Outcome(scores, seconds, (min(seeds), max(seeds)), errors)
