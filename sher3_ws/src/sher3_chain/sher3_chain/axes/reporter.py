"""What a report shows that only a chain of axes knows."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_diagnosis.channel import Channel
from sher3_diagnosis.reporter import Output, Reporter

from sher3_chain.axes.evidence import AxisEvidence


class AxesReporter(Reporter[AxisEvidence]):
    """The part of the axes in a report: what is left out of a fit is a block of a record."""

    held_out = "blocks"
    end = "axis run again"

    def data(self, parts: Sequence[AxisEvidence]) -> str:
        """Return records, axes, and how long was recorded in all."""
        runs = parts[0].runs if parts else ()
        seconds = sum(run.period * len(samples_of(run.signals)) for run in runs)
        axes = ", ".join(part.axis.name for part in parts)
        return f"{len(runs)} record{'s' * (len(runs) != 1)}, {seconds:.0f} s of {axes}"

    def run_name(self, evidence: AxisEvidence, run: int) -> str:
        """Return the name of the record that a block belongs to."""
        return f"Record {evidence.runs[evidence.records.index(evidence.data.views[run])].name}"

    def together(self, evidence: AxisEvidence, run: int) -> Sequence[int]:
        """Return the blocks of the same record."""
        views = evidence.data.views
        return [k for k, view in enumerate(views) if view is views[run]]

    def output(self, evidence: AxisEvidence, run: int, channel: Channel) -> Output:
        """Return the force of a driven axis, real against nominal against corrected; else what a residual is."""
        if channel.stage == "transmission":
            return Output("load − motor")
        signals = evidence.records[evidence.records.index(evidence.data.views[run])].run
        if evidence.axis.servo or signals.effort is None:
            return Output("set-point − position")
        return Output("force", signals.to_grid(signals.effort)[:, 0])


def samples_of(signals: dict) -> Sequence[float]:
    """Return any signal of a record: all have its length."""
    return next((x for of_axis in signals.values() for x in of_axis.values()), ())
