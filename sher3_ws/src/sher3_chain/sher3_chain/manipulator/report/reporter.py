"""What a report shows that only a serial arm in motion knows."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_diagnosis.channel import Channel
from sher3_diagnosis.finding import Findings
from sher3_diagnosis.reporter import Output, Reporter, Table

from sher3_chain.axes.reporter import samples_of
from sher3_chain.manipulator.evidence import ArmMotionEvidence
from sher3_chain.manipulator.library import of_joints
from sher3_chain.manipulator.report.table import table_of


class ManipulatorReporter(Reporter[ArmMotionEvidence]):
    """The part of an arm in motion in a report: measured, nominal and corrected effort over time."""

    held_out = "blocks"

    def data(self, parts: Sequence[ArmMotionEvidence]) -> str:
        """Return records, joints, and how long was recorded in all."""
        evidence = parts[0]
        seconds = sum(run.period * len(samples_of(run.signals)) for run in evidence.runs)
        joints = len(evidence.described.joints)
        return f"{len(evidence.runs)} record{'s' * (len(evidence.runs) != 1)}, {seconds:.0f} s of {joints} joints"

    def run_name(self, evidence: ArmMotionEvidence, run: int) -> str:
        """Return the name of the record that a block belongs to."""
        return f"Record {evidence.runs[evidence.records.index(evidence.data.views[run])].name}"

    def together(self, evidence: ArmMotionEvidence, run: int) -> Sequence[int]:
        """Return the blocks of the same record."""
        views = evidence.data.views
        return [k for k, view in enumerate(views) if view is views[run]]

    def table(self, diagnosis: Findings[ArmMotionEvidence]) -> Table | None:
        """Return joints by constants; None where no joint was looked at."""
        if not diagnosis.findings or not diagnosis.verdict.causes:
            return None
        evidence = diagnosis.findings[0].evidence
        names = [joint.name for joint in evidence.described.joints]
        return table_of(diagnosis.verdict.causes, of_joints(), names, evidence.judged)

    def output(self, evidence: ArmMotionEvidence, run: int, channel: Channel) -> Output:
        """Return the effort of a joint."""
        view = evidence.records[evidence.records.index(evidence.data.views[run])]
        return Output("effort", view.effort[:, view.row(channel.actuator)])
