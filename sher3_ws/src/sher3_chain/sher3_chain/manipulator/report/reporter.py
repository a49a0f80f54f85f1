"""What a report shows that only a serial arm in motion knows."""

from __future__ import annotations

import shlex
from collections.abc import Sequence

from sher3_diagnosis.channel import Channel
from sher3_diagnosis.finding import Findings
from sher3_diagnosis.reporter import Output, Table

from sher3_chain.chain.reporter import ChainReporter
from sher3_chain.manipulator.evidence import ArmMotionEvidence
from sher3_chain.manipulator.library import of_joints
from sher3_chain.manipulator.report.table import table_of


class ManipulatorReporter(ChainReporter[ArmMotionEvidence]):
    """The part of an arm in motion in a report: measured, nominal and corrected effort over time."""

    def __init__(self, model: str, mjcf: bool) -> None:
        """Take the file of the arm, and whether it is one of MuJoCo or a URDF."""
        kind, ending = ("mjcf", "xml") if mjcf else ("urdf", "urdf")
        self.target = f"--to {kind} --model {shlex.quote(model)} --out corrected.{ending}"

    def joints(self, parts: Sequence[ArmMotionEvidence]) -> str:
        """Return the number of joints."""
        return f"{len(parts[0].described.joints)} joints"

    def table(self, diagnosis: Findings[ArmMotionEvidence]) -> Table | None:
        """Return joints by constants; None where no joint was looked at."""
        if not diagnosis.findings or not diagnosis.verdict.causes:
            return None
        evidence = diagnosis.findings[0].evidence
        names = [joint.name for joint in evidence.described.joints]
        return table_of(diagnosis.verdict.causes, of_joints(), names, evidence.judged)

    def output(self, evidence: ArmMotionEvidence, run: int, channel: Channel) -> Output:
        """Return the effort of a joint."""
        view = evidence.records[evidence.record_of(run)]
        return Output("effort", view.effort[:, view.row(channel.actuator)])
