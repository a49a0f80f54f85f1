"""Certified silence: from which odds on causes are named so that few of the names are wrong, with a bound.

Learn then test (Angelopoulos and others, 2021): each threshold of a fixed grid is a hypothesis "of the causes
named from here on more than the risk are wrong". An exact binomial test rejects it; the level is shared out over the
grid, so that with the stated confidence no threshold is certified wrongly, whatever the distribution. What is assumed
is that a new cause is drawn as the labelled ones were: same robots, same faults, one by one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from scipy.stats import binom

from sher3_challenge.score.reliability import Stated

RISKS = (0.01, 0.05, 0.10)
"""Shares of wrong names that are asked for."""
CONFIDENCE = 0.95
GRID = (0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99)
"""Thresholds on the probability, loosest first; fixed before any case was seen."""


@dataclass(frozen=True)
class Certified:
    """The loosest threshold that keeps a risk.

    Attributes:
        risk: share of the names that may be wrong.
        threshold: probability from which causes are named; None where the cases are too few, or too often wrong.
        named, wrong: of the labelled causes, from the threshold on.
        causes: labelled causes in all.
    """

    risk: float
    threshold: float | None
    named: int
    wrong: int
    causes: int

    @property
    def answered(self) -> float:
        """Share of the labelled causes that are named."""
        return self.named / self.causes if self.causes else 0.0


def needed(risk: float, wrong: int = 0, confidence: float = CONFIDENCE) -> int:
    """Return how many names, `wrong` of them wrong, are the fewest that certify a threshold for a risk."""
    level = (1.0 - confidence) / len(GRID)
    enough = wrong + 1
    while binom.cdf(wrong, enough, risk) > level:
        enough += 1
    return enough


def certified(stated: Sequence[Stated], risk: float) -> Certified:
    """Return the loosest threshold of the grid whose names are wrong with at most the risk, at that confidence.

    Args:
        stated: per labelled cause the probability that it is the library's, and whether it is.
        risk: share of wrong names.
    """
    level = (1.0 - CONFIDENCE) / len(GRID)
    for threshold in GRID:
        named = [right for p, right in stated if p >= threshold]
        wrong = len(named) - sum(named)
        if named and binom.cdf(wrong, len(named), risk) <= level:
            return Certified(risk, threshold, len(named), wrong, len(stated))
    return Certified(risk, None, 0, 0, len(stated))


def curve(stated: Sequence[Stated]) -> str:
    """Return the share named at each risk as a table in Markdown; where none is certified, what it would take."""
    lines = ["| wrong names at most | named from | causes named | wrong |", "|---|---|---|---|"]
    for found in (certified(stated, risk) for risk in RISKS):
        lacking = f"no odds certified: {needed(found.risk)} right names in a row would"
        start = lacking if found.threshold is None else f"{found.threshold:g}"
        lines.append(f"| {found.risk:g} | {start} | {found.answered:.2f} (n {found.causes}) | {found.wrong} |")
    return "\n".join(lines)
