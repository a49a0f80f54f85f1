"""Positioning tests as a machine of the diagnosis, each test a part of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.attribute.search import Left, Say, attribute
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.finding import Finding
from sher3_diagnosis.machine import Machine, Policy
from sher3_effects import pages

from sher3_static.positioning.description import AxisTest, PositioningDescription
from sher3_static.positioning.evidence import TableEvidence, gather_axis_test, gather_circle
from sher3_static.positioning.ranking import ranking
from sher3_static.positioning.record import Tests

if TYPE_CHECKING:
    from sher3_static.positioning.reporter import PositioningReporter


MOST = 6
"""Causes named at most: a table may have one of each page."""


@dataclass(frozen=True)
class Positioning(Machine[Tests, TableEvidence]):
    """Axes and planes of a machine tool or stage, each measured by itself.

    Attributes:
        description: the tests.
    """

    description: PositioningDescription
    policy = Policy(down_to_floor=True)

    def library(self) -> Sequence[Effect]:
        """Return the pages for tables and circles."""
        return [*pages("table"), *pages("circle")]

    def effects(self, evidence: TableEvidence) -> Sequence[Effect]:
        """Return the pages of the test, periods only where the lead is known."""
        if isinstance(evidence.test, AxisTest):
            return pages("table", {"lead"} if evidence.test.lead else set())
        return pages("circle")

    def audit(self, runs: Sequence[Tests]) -> list[str]:
        """Return what was done to the data."""
        return [note for run in runs for note in run.notes]

    def gather(self, runs: Sequence[Tests]) -> Sequence[TableEvidence]:
        """Return every test as a part; raises MachineError where nothing tells what repeats."""
        axes = [gather_axis_test(test, runs) for test in self.description.axes]
        return [*axes, *(gather_circle(test, runs) for test in self.description.planes)]

    def attribute(self, evidence: TableEvidence, candidates: Candidates, left_over: Left, say: Say) -> Attribution:
        """Search for up to six causes: a table may have one of each page."""
        return attribute(candidates, left_over, say, MOST)

    def remarks(self, finding: Finding[TableEvidence]) -> list[str]:
        """Return the contribution ranking."""
        return ranking(finding.evidence, finding.attribution)

    def reporter(self) -> PositioningReporter:
        """Return the part of this machine in a report."""
        from sher3_static.positioning.reporter import PositioningReporter

        return PositioningReporter()
