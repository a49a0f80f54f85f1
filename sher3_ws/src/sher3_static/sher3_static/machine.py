"""A table of readings as a machine of the diagnosis: one machine for every kind of table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.attribute.search import Left, Say
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.finding import Finding
from sher3_diagnosis.machine import Machine, Policy
from sher3_diagnosis.verdict import Cause, Interval

from sher3_static.readings import Readings
from sher3_static.table import TableEvidence, eaten, evidence_of, zeros_in_words

if TYPE_CHECKING:
    from sher3_static.kind import TableKind
    from sher3_static.reporter import TableReporter


@dataclass(frozen=True)
class StaticTest(Machine[Readings, TableEvidence]):
    """Tables of readings of one machine, each judged by itself.

    Attributes:
        kind: which tables they are.
        known: what the kind knows of the machine.
    """

    kind: TableKind[Any]
    known: Any

    @property
    def policy(self) -> Policy:  # type: ignore[override]
        """What the judgement may lean on."""
        return self.kind.policy

    def library(self) -> Sequence[Effect]:
        """Return every page for tables of this kind."""
        return self.kind.library()

    def effects(self, evidence: TableEvidence) -> Sequence[Effect]:
        """Return the pages of one table."""
        return evidence.table.pages

    def audit(self, runs: Sequence[Readings]) -> list[str]:
        """Return what was done to the data."""
        return [note for run in runs for note in run.notes]

    def gather(self, runs: Sequence[Readings]) -> Sequence[TableEvidence]:
        """Return every table as a part; raises MachineError where nothing tells what repeats."""
        return [evidence_of(table) for table in self.kind.tables(self.known, runs)]

    def attribute(self, evidence: TableEvidence, candidates: Candidates, left_over: Left, say: Say) -> Attribution:
        """Search for causes as the kind does."""
        return self.kind.attribute(evidence, candidates, left_over, say)

    def remarks(self, finding: Finding[TableEvidence]) -> list[str]:
        """Return what the kind and the pages of the causes say, and how far the zeros of runs are apart."""
        zeros = zeros_in_words(finding.evidence, finding.attribution.fit)
        return [*self.kind.remarks(finding), *causes_in_words(finding), *zeros]

    def unjudged(self, finding: Finding[TableEvidence]) -> dict[Channel, str]:
        """Say where the scatter of the readings hides whatever is looked for."""
        table = finding.evidence.table
        why = "" if finding.significant else eaten(table)
        return {table.channel: why} if why else {}

    def end_to_end(self, findings: Sequence[Finding[TableEvidence]], causes: Sequence[Cause]) -> Interval | None:
        """Return the closure at the end of the chain, where the table is of that end."""
        return self.kind.end_to_end(findings)

    def reporter(self) -> TableReporter:
        """Return the part of this kind in a report."""
        from sher3_static.reporter import TableReporter

        return TableReporter(self.kind.words)


def causes_in_words(finding: Finding[TableEvidence]) -> list[str]:
    """Return what the pages of the causes say of their parameters on this machine."""
    view = finding.evidence.table.view
    told = [t.effect.in_words(view, t.effect.parameters(t.shape, found)) for t, found in finding.attribution.told]
    return [note for note in told if note]
