"""What a report shows that only a chain of axes knows."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_diagnosis.channel import Channel
from sher3_diagnosis.reporter import Output

from sher3_chain.axes.evidence import AxisEvidence
from sher3_chain.chain.reporter import ChainReporter


class AxesReporter(ChainReporter[AxisEvidence]):
    """The part of the axes in a report."""

    end = "axis run again"

    def joints(self, parts: Sequence[AxisEvidence]) -> str:
        """Return the names of the axes."""
        return ", ".join(part.axis.name for part in parts)

    def output(self, evidence: AxisEvidence, run: int, channel: Channel) -> Output:
        """Return the force of a driven axis, real against nominal against corrected; else what a residual is."""
        if channel.stage == "transmission":
            return Output("load − motor")
        signals = evidence.records[evidence.record_of(run)].run
        if evidence.axis.servo or signals.effort is None:
            return Output("set-point − position")
        return Output("force", signals.to_grid(signals.effort)[:, 0])
