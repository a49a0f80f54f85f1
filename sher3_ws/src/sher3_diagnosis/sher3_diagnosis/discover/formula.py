"""A discovered formula: terms with units and intervals, and how far the gap shrinks on runs left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sher3_diagnosis.channel import Channel
from sher3_diagnosis.discover.feature import Feature
from sher3_diagnosis.verdict import Interval, Parameter


@dataclass(frozen=True)
class FoundTerm:
    """One term.

    Attributes:
        feature: what the gap is in proportion to.
        component: of the residual: 0 for an axis; 0 to 5 for a pose or a wrench.
        coefficient: with unit and 95 % interval.
        again: of the folds, how many found a term of the same laws and quantities.
    """

    feature: Feature
    component: int
    coefficient: Parameter
    again: int


@dataclass(frozen=True)
class Discovery:
    """What was found at a place.

    Attributes:
        channels: of the place; the first names it.
        terms: of the formula, largest part of the gap first; none where nothing can be claimed.
        closure: of the gap on runs that neither formula nor coefficients were found on; None without a formula.
        ceiling: closure of boosted trees of the same inputs, on the same runs.
        sentences: the formula in plain language, one for each term.
        folds: parts of the runs, each left out once.
        note: why nothing is claimed.
    """

    channels: Sequence[Channel]
    terms: Sequence[FoundTerm] = ()
    closure: Interval | None = None
    ceiling: Interval | None = None
    sentences: Sequence[str] = ()
    folds: int = 0
    note: str = ""

    @property
    def channel(self) -> Channel:
        """The channel that names the place."""
        return self.channels[0]

    @property
    def claimed(self) -> bool:
        """Whether there is a formula."""
        return bool(self.terms)
