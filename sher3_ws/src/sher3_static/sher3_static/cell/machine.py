"""A load cell as a machine of the diagnosis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.attribute.search import Left, Say, attribute
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.finding import Finding
from sher3_diagnosis.machine import Machine, Policy
from sher3_effects import pages

from sher3_static.cell.description import CellDescription
from sher3_static.cell.evidence import READING, gather_cell
from sher3_static.cell.record import CellRun

if TYPE_CHECKING:
    from sher3_static.cell.reporter import CellReporter

MOST = 5
"""Causes named at most: a cell may have one of each page."""


@dataclass(frozen=True)
class LoadCell(Machine[CellRun, Evidence]):
    """A force or torque sensor of one axis under known loads.

    Attributes:
        description: what was recorded.
    """

    description: CellDescription
    policy = Policy(down_to_floor=True)

    def library(self) -> Sequence[Effect]:
        """Return the pages for a cell."""
        return pages("cell")

    def audit(self, runs: Sequence[CellRun]) -> list[str]:
        """Return what was done to the data."""
        return [note for run in runs for note in run.notes]

    def gather(self, runs: Sequence[CellRun]) -> Sequence[Evidence]:
        """Return the cell as one part."""
        return [gather_cell(self.description, runs)]

    def attribute(self, evidence: Evidence, candidates: Candidates, left_over: Left, say: Say) -> Attribution:
        """Search for up to five causes."""
        return attribute(candidates, left_over, say, MOST)

    def remarks(self, finding: Finding[Evidence]) -> list[str]:
        """Return what data sheets of cells state: errors in shares of the range."""
        view, floor = finding.evidence.data.views[0], finding.evidence.data.floors[0][READING][0]
        whole = float(np.abs(view.applied).max())
        notes = [f"readings scatter by {100.0 * floor / whole:.2g}% of the largest force"]
        for cause in finding.causes:
            for name in ("loop", "largest", "over_test", "force"):
                if name in cause.parameters:
                    notes.append(f"{cause.effect}: {100.0 * cause.parameters[name].value / whole:.2g}% of it")
        return notes

    def reporter(self) -> CellReporter:
        """Return the part of this machine in a report."""
        from sher3_static.cell.reporter import CellReporter

        return CellReporter()
