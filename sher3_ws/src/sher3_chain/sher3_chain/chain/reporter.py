"""What a report shows of any chain of joints."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import TypeVar

from sher3_diagnosis.reporter import Reporter

from sher3_chain.chain.evidence import ChainEvidence

E = TypeVar("E", bound=ChainEvidence)


class ChainReporter(Reporter[E]):
    """The part of a chain in a report: what is left out of a fit is a block of a record."""

    held_out = "blocks"

    @abstractmethod
    def joints(self, parts: Sequence[E]) -> str:
        """Return of what was recorded, in words."""

    def data(self, parts: Sequence[E]) -> str:
        """Return records, joints, and how long was recorded in all."""
        runs = parts[0].runs if parts else ()
        seconds = sum(run.period * run.ticks for run in runs)
        return f"{len(runs)} record{'s' * (len(runs) != 1)}, {seconds:.0f} s of {self.joints(parts)}"

    def run_name(self, evidence: E, run: int) -> str:
        """Return the name of the record that a block belongs to."""
        return f"Record {evidence.runs[evidence.record_of(run)].name}"

    def together(self, evidence: E, run: int) -> Sequence[int]:
        """Return the blocks of the same record."""
        views = evidence.data.views
        return [k for k, view in enumerate(views) if view is views[run]]
