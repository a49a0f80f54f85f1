"""What a report shows that only a serial arm knows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.reporter import FLOWS, Output, Reporter

from sher3_static.arm.evidence import ArmEvidence


class ArmReporter(Reporter[ArmEvidence]):
    """The part of a serial arm in a report: postures, not time."""

    flows = {**FLOWS, "mechanism": "joint positions → pose"}
    abscissa = "posture"
    held_out = "postures"
    end = "measured pose"

    def data(self, parts: Sequence[ArmEvidence]) -> str:
        """Return the number of postures."""
        return f"{parts[0].postures} postures, measured from outside"

    def run_name(self, evidence: ArmEvidence, run: int) -> str:
        """Return what is drawn: every posture."""
        return "All postures"

    def together(self, evidence: ArmEvidence, run: int) -> Sequence[int]:
        """Return all folds: each posture is in one of them."""
        return range(len(evidence.excitations))

    def clock(self, evidence: ArmEvidence, run: int) -> Array:
        """Return the number of each posture, (g,)."""
        return np.arange(evidence.postures, dtype=float)

    def output(self, evidence: ArmEvidence, run: int, channel: Channel) -> Output:
        """Return the name of the residual."""
        return Output("measured − nominal pose")
