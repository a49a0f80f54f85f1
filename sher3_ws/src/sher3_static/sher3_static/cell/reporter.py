"""What a report shows that only a load cell knows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.reporter import FLOWS, Output, Reporter


class CellReporter(Reporter[Evidence]):
    """The part of a load cell in a report: readings, not time."""

    flows = {**FLOWS, "sensing": "force → reading"}
    abscissa = "reading"
    held_out = "readings"
    end = "of the reading"

    def data(self, parts: Sequence[Evidence]) -> str:
        """Return the number of readings."""
        return f"{len(parts[0].data.views[0].applied)} readings under known forces"

    def run_name(self, evidence: Evidence, run: int) -> str:
        """Return what is drawn: every reading."""
        return "All readings"

    def together(self, evidence: Evidence, run: int) -> Sequence[int]:
        """Return all folds: each reading is in one of them."""
        return range(len(evidence.excitations))

    def clock(self, evidence: Evidence, run: int) -> Array:
        """Return the number of each reading, (g,)."""
        return np.arange(len(evidence.data.views[0].applied), dtype=float)

    def output(self, evidence: Evidence, run: int, channel: Channel) -> Output:
        """Return the name of the residual."""
        return Output("reading − force")
