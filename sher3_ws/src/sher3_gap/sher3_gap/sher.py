"""The SHER as a machine of the diagnosis, and the diagnosis of its case folders."""

from __future__ import annotations

import time
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from sher3_common.progress import Say, silent
from sher3_description import Robot
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.finding import ExactFinding, Finding
from sher3_diagnosis.flow import diagnose
from sher3_diagnosis.judge.costs import DEFAULT, Costs
from sher3_diagnosis.machine import Diagnosis, Machine, Rehearsal
from sher3_diagnosis.verdict import Cause, Interval, Noise
from sher3_effects import library

from sher3_gap.case.audit import audit
from sher3_gap.case.loading import load_case
from sher3_gap.evidence import SherEvidence, gather
from sher3_gap.signals import RunSignals
from sher3_gap.simulate.tip import tip_closure
from sher3_gap.stages.exact.controller import controller_finding
from sher3_gap.stages.exact.evidence import exact_evidence
from sher3_gap.stages.exact.findings import with_pages
from sher3_gap.stages.exact.transport import transport_finding
from sher3_gap.stages.noise import noise_of_sensors

if TYPE_CHECKING:
    from sher3_gap.report.reporter import SherReporter


@dataclass(frozen=True)
class Sher(Machine[RunSignals, SherEvidence]):
    """The robot with its nominal model.

    Attributes:
        robot: the model that the host and the nominal simulator believe.
    """

    robot: Robot

    def library(self) -> Sequence[Effect]:
        """Return every effect of the robot."""
        return list(library().values())

    def audit(self, runs: Sequence[RunSignals]) -> list[str]:
        """Refuse unit slips and unequal repeats (CaseError); return what narrows the answer."""
        return audit(runs, self.robot)

    def gather(self, runs: Sequence[RunSignals]) -> list[SherEvidence]:
        """Return the robot as one part: an effect of its platform shows on several axes."""
        return [gather(runs, self.robot)]

    def exact(
        self, runs: Sequence[RunSignals], evidence: Sequence[SherEvidence], without: Collection[str]
    ) -> list[ExactFinding]:
        """Judge transport and controller, whose nominal output is computed to rounding."""
        timing = evidence[0].timing
        found = (transport_finding(timing, runs, self.robot, without), controller_finding(runs, self.robot, without))
        out = []
        for finding in (f for f in found if f is not None):
            gathered = partial(exact_evidence, runs, self.robot, finding.where.stage)
            out.append(replace(with_pages(finding, gathered, without), evidence=gathered))
        return out

    def noise(self, runs: Sequence[RunSignals]) -> list[Noise]:
        """Return the noise of encoders, efforts, force sensor and tracker."""
        return noise_of_sensors(runs, self.robot)

    def rehearsals(self, evidence: SherEvidence, felt: Collection[str]) -> Iterator[Rehearsal]:
        """Yield the standard set as the nominal robot foresees it."""
        from sher3_gap.experiments.foreseen import foreseen

        yield from foreseen(evidence, felt)

    def end_to_end(self, findings: Sequence[Finding[SherEvidence]], causes: Sequence[Cause]) -> Interval | None:
        """Return the closure of the tip in free runs of the simulator."""
        return tip_closure(findings[0].evidence, causes, findings[0].attribution.fit)

    def reporter(self) -> SherReporter:
        """Return the robot's part of a report."""
        from sher3_gap.report.reporter import SherReporter

        return SherReporter()


def diagnose_runs(
    runs: Sequence[RunSignals],
    robot: Robot,
    without: Collection[str] = (),
    say: Say = silent,
    started: float | None = None,
    costs: Costs = DEFAULT,
) -> Diagnosis[SherEvidence]:
    """Diagnose runs of one robot in one condition; see `sher3_diagnosis.diagnose`."""
    return diagnose(Sher(robot), runs, without, say, started, costs)


def diagnose_case(
    case: Path | str,
    robot: Path | None = None,
    without: Collection[str] = (),
    say: Say = silent,
    costs: Costs = DEFAULT,
) -> Diagnosis[SherEvidence]:
    """Diagnose a case folder.

    Args:
        case: folder of the recorded-run contract, section 5.
        robot: `robot.yaml` of the nominal model; default the case's own.
        without: effect ids that are left out of the library.
        say: takes a line of progress.
        costs: of wrong answers.

    Raises:
        CaseError: the case cannot be diagnosed; the error names the run, the value and the remedy.
        UnknownEffect: an id in `without` is no effect.
    """
    started = time.perf_counter()
    runs, model = load_case(Path(case), robot, say)
    return diagnose_runs(runs, model, without, say, started, costs)
