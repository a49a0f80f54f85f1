"""What a report shows that only positioning tests know."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.reporter import FLOWS, Output, Reporter

from sher3_static.positioning.evidence import TableEvidence


class PositioningReporter(Reporter[TableEvidence]):
    """The part of positioning tests in a report: rows, not time."""

    flows = {**FLOWS, "transmission": "target → position", "mechanism": "circle → radius"}
    abscissa = "row"
    held_out = "cycles"
    end = "at the reference"

    def data(self, parts: Sequence[TableEvidence]) -> str:
        """Return the number of rows of each test."""
        return ", ".join(
            f"{part.test.name}: {len(part.rows['cycle' if 'cycle' in part.rows else 'angle'])} rows" for part in parts
        )

    def run_name(self, evidence: TableEvidence, run: int) -> str:
        """Return what is drawn: every row."""
        return f"All rows of {evidence.test.name}"

    def together(self, evidence: TableEvidence, run: int) -> Sequence[int]:
        """Return all blocks: each row is in one of them."""
        return range(len(evidence.excitations))

    def clock(self, evidence: TableEvidence, run: int) -> Array:
        """Return the number of each row, (g,)."""
        return np.arange(evidence.data.views[0].rows, dtype=float)

    def output(self, evidence: TableEvidence, run: int, channel: Channel) -> Output:
        """Return the name of the residual."""
        return Output("reading − target" if channel.stage == "transmission" else "radius − nominal")
