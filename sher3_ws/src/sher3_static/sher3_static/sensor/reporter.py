"""What a report shows that only a force sensor knows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.reporter import FLOWS, Output, Reporter

from sher3_static.sensor.evidence import SensorEvidence


class SensorReporter(Reporter[SensorEvidence]):
    """The part of a force sensor in a report: readings, not time."""

    flows = {**FLOWS, "sensing": "load → reading"}
    abscissa = "reading"
    held_out = "readings"
    end = "of the reading"

    def data(self, parts: Sequence[SensorEvidence]) -> str:
        """Return the number of readings."""
        return f"{len(parts[0].data.views[0].orientation)} readings in known orientations"

    def run_name(self, evidence: SensorEvidence, run: int) -> str:
        """Return what is drawn: every reading."""
        return "All readings"

    def together(self, evidence: SensorEvidence, run: int) -> Sequence[int]:
        """Return all folds: each reading is in one of them."""
        return range(len(evidence.excitations))

    def clock(self, evidence: SensorEvidence, run: int) -> Array:
        """Return the number of each reading, (g,)."""
        return np.arange(len(evidence.data.views[0].orientation), dtype=float)

    def output(self, evidence: SensorEvidence, run: int, channel: Channel) -> Output:
        """Return the name of the residual."""
        return Output("reading − nominal")
