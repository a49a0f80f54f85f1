"""What was found: on one part of a machine by fitting, with its odds, and in one exact stage without a fit."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.localise.gaps import Gap
from sher3_diagnosis.thresholds import REPRODUCED
from sher3_diagnosis.verdict import Cause, Imitation, Interval, Residual, Verdict, Where

E = TypeVar("E", bound=Evidence)

OUTSIDE, NO_GAP, LIBRARY = "outside_library", "no_gap", "library"
"""The answers that a probability is given to."""


@dataclass(frozen=True)
class Candidate:
    """An effect at a site that may be a cause, and how far it is from explaining as much as the named cause.

    Attributes:
        effect, site, family: of the effect; `contains`: the simpler effects that it contains.
        unlikeness: 0 of the cause itself; below 1 nearly the same data.
    """

    effect: str
    site: str
    family: str
    contains: tuple[str, ...]
    unlikeness: float


@dataclass(frozen=True)
class Item:
    """One cause or one gap, with its evidence.

    Attributes:
        channel: where it shows most.
        index: of the cause's term in its fit; None for a gap without a cause.
        numbers: the evidence by name.
        candidates: of a cause, the effects that may stand in its place, itself first.
    """

    channel: Channel
    index: int | None
    numbers: Mapping[str, float]
    candidates: Sequence[Candidate] = ()


@dataclass(frozen=True)
class Judged:
    """An item with its probabilities, which add up to one.

    Attributes:
        item: what was judged.
        effects: per candidate of the item, the probability that it is the cause.
        outside: that the cause is none of the library.
        no_gap: that the item is no gap, or no cause, of its own.
        closure: of a cause; None of a gap without one.
        typicality: of a cause, the share of the labelled ones that are at least as unusual; None where nothing tells.
    """

    item: Item
    effects: Sequence[float]
    outside: float
    no_gap: float
    closure: Interval | None = None
    typicality: float | None = None

    @property
    def library(self) -> float:
        """Probability that the true effect is among the candidates."""
        return float(sum(self.effects))

    @property
    def odds(self) -> dict[str, float]:
        """Probabilities of library, outside and no gap."""
        return {LIBRARY: self.library, OUTSIDE: self.outside, NO_GAP: self.no_gap}


@dataclass(frozen=True)
class ExactFinding:
    """What an exact stage says: its error is computed, not fitted, and its floor is rounding.

    Attributes:
        where: the stage, its gap and floor.
        causes: that reproduce it; none when nothing does.
        closure: of all of them together.
        residual: what they leave.
        note: why nothing reproduces it.
        evidence: gathers the errors of its axes with whatever a law of them might depend on, for discovery.
    """

    where: Where
    causes: Sequence[Cause]
    closure: Interval
    residual: Residual
    note: str = ""
    evidence: Callable[[], Evidence] | None = None

    @property
    def closed(self) -> bool:
        """Whether its causes reproduce its error."""
        return self.closure.value >= REPRODUCED


@dataclass(frozen=True)
class Finding(Generic[E]):
    """What was found on one part of a machine.

    Attributes:
        evidence: of the part.
        gaps: of every channel, most significant first.
        attribution: the causes and their rivals.
        causes: quantified, in the order of the attribution.
        left: gaps that remain with the causes: channel -> excess loss.
        notes: what the machine says of the part.
        judged: causes and gaps with their odds.
        whole: the finding with every cause that was found, named or not; None where it is this one.
        imitations: effects that fit a gap although they are hardly its cause.
        dismissed: channels above their floor that are judged to have no gap of their own.
    """

    evidence: E
    gaps: Sequence[Gap]
    attribution: Attribution
    causes: Sequence[Cause]
    left: dict[Channel, float]
    notes: Sequence[str] = field(default_factory=tuple)
    judged: Sequence[Judged] = ()
    whole: Finding[E] | None = None
    imitations: Sequence[Imitation] = ()
    dismissed: frozenset[Channel] = frozenset()

    @property
    def with_all(self) -> Finding[E]:
        """The finding with every cause that was found."""
        return self if self.whole is None else self.whole

    @property
    def significant(self) -> dict[Channel, Gap]:
        """Channels with a gap, most significant first."""
        return {g.channel: g for g in self.gaps if g.significant and g.channel not in self.dismissed}

    def cause_of(self, index: int) -> Cause:
        """Return the quantified cause of a term of the fit."""
        return self.causes[self.attribution.causes.index(index)]


@dataclass(frozen=True)
class Findings(Generic[E]):
    """A verdict with what it rests on.

    Attributes:
        verdict: the answer.
        findings: one for each part of the machine.
        exact: what the exact stages say.
    """

    verdict: Verdict
    findings: Sequence[Finding[E]]
    exact: Sequence[ExactFinding]
