"""What a machine is to the engine: it turns runs into evidence and says which effects it may have.

A machine is a value. `diagnose(machine, runs)` asks it for everything that is particular to it; whatever is not said
here is the same for all machines.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Generic, NamedTuple, TypeVar

from sher3_common.progress import Say

from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.plan import SearchPlan
from sher3_diagnosis.attribute.planned import planned
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.attribute.search import Left
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.finding import ExactFinding, Finding, Findings
from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.fit.term import Term
from sher3_diagnosis.fit.tolerance import within
from sher3_diagnosis.reporter import Reporter
from sher3_diagnosis.verdict import Cause, Identified, Interval, Noise, Within

R = TypeVar("R")
"""A run as the machine reads it."""
E = TypeVar("E", bound=Evidence)
"""The machine's own evidence: the engine's, with whatever its simulator needs."""


class Rehearsal(NamedTuple):
    """An experiment as a machine's model foresees it.

    Attributes:
        excitation: its name.
        purpose: what is to be run, and why.
        added: what the recorded runs had not, as a tracker or another temperature, in words; empty for none.
        data: its runs, of which no residual is looked at.
        elsewhere: whether they go where none was recorded, so that a law may be bent there as nobody has seen.
        as_built: makes the deviations within tolerance that recorded and further runs together show, in their order;
            None where they are those that the recorded runs show.
    """

    excitation: str
    purpose: str
    added: str
    data: Standardised
    elsewhere: bool = True
    as_built: Callable[[], Sequence[Term]] | None = None


@dataclass(frozen=True)
class Policy:
    """What a machine's descriptions allow the judgement to lean on.

    Attributes:
        swept: causes that say nothing are left out before they are weighed (`judge.meaning`, `judge.borne_out`).
        own_level: in the odds the machine itself tells how far it is from its pages; otherwise it is as far as the
            robots that set the weights.
        carried: an effect whose size may be zero stays in the fit without a name. For machines of which every part has
            a small error of its own; otherwise it has a name where its gap needs it.
        absences: a place without a gap says from which size on each plain law would have shown. For machines on which
            such sizes were measured to be seen.
    """

    swept: bool = False
    own_level: bool = False
    carried: bool = False
    absences: bool = False


class Machine(ABC, Generic[R, E]):
    """A machine that can be diagnosed.

    Attributes:
        policy: what the judgement may lean on.
        sources: names of the packages whose versions a verdict records.
    """

    policy: Policy = Policy()
    sources: tuple[str, ...] = ("sher3", "numpy", "scipy")

    @abstractmethod
    def gather(self, runs: Sequence[R]) -> Sequence[E]:
        """Compute residuals and floors; one piece of evidence for each part that is judged by itself."""

    @abstractmethod
    def library(self) -> Sequence[Effect]:
        """Return every effect the machine may have."""

    def of(self, evidence: E) -> Machine[R, E]:
        """Return the machine that looks for the causes of one part; default this one. Parts of two kinds have two."""
        return self

    def effects(self, evidence: E) -> Sequence[Effect]:
        """Return the effects that one part may have; default all of the library."""
        return self.library()

    def audit(self, runs: Sequence[R]) -> list[str]:
        """Refuse runs that cannot support an answer; return a sentence for each thing that narrows the answer."""
        return []

    def exact(self, runs: Sequence[R], evidence: Sequence[E], without: Collection[str]) -> list[ExactFinding]:
        """Judge the stages whose error is computed without a fit; `without` are effects not to be named."""
        return []

    def plan(self, evidence: E) -> SearchPlan:
        """Return how the causes of one part are looked for; default one by one, leaving what laws leave."""
        return SearchPlan()

    def attribute(self, evidence: E, candidates: Candidates, left_over: Left, say: Say) -> Attribution:
        """Choose the causes of one part; default by its plan alone."""
        return planned(candidates, self.plan(evidence), left_over, say)

    def refine(self, evidence: E, causes: list[Cause], attribution: Attribution) -> tuple[E, list[Cause]]:
        """Improve a part's causes, and nominal constants found from the data, beyond what the fit can do.

        Default: both as they are.
        """
        return evidence, causes

    def within(self, finding: Finding[E]) -> list[Within]:
        """Return a part's deviations within its tolerances; default those of the terms that are no causes."""
        return within(finding.evidence.data, finding.attribution.fit)

    def remarks(self, finding: Finding[E]) -> list[str]:
        """Return notes on one part; default none."""
        return []

    def identified(self, evidence: E) -> Sequence[Identified]:
        """Return the inertias of a part that were found from the data, and are no causes; default none."""
        return ()

    def noise(self, runs: Sequence[R]) -> Sequence[Noise]:
        """Return how noisy the readings of every place are; default none, as of tables that have no clock."""
        return ()

    def unjudgeable(self, finding: Finding[E]) -> dict[Channel, str]:
        """Return why channels of a part without a gap cannot be judged: their floor hides what is looked for.

        Default none. Where there is any, no gap elsewhere does not make a verdict of no gap.
        """
        return {}

    def rehearsals(self, evidence: E, felt: Collection[str]) -> Iterator[Rehearsal]:
        """Yield experiments, the cheapest to make first, for what they would tell of causes; default none.

        Args:
            evidence: of the recorded runs.
            felt: quantities of `sher3_diagnosis.effect.INPUTS` that the causes depend on: no other is worth changing.
        """
        yield from ()

    def end_to_end(self, findings: Sequence[Finding[E]], causes: Sequence[Cause]) -> Interval | None:
        """Return the closure of the machine run again in its simulator, at the end of its chain; default none."""
        return None

    def reporter(self) -> Reporter[E]:
        """Return the machine's own sections of the report; default none."""
        return Reporter()


@dataclass(frozen=True)
class Diagnosis(Findings[E]):
    """A verdict with what it rests on, and the machine that was diagnosed, for reports and further experiments."""

    machine: Machine[Any, E]
