"""What the report shows that only the SHER knows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sher3_description import ACTUATORS
from sher3_diagnosis.channel import STAGES, Array, Channel
from sher3_diagnosis.finding import Findings
from sher3_diagnosis.reporter import FLOWS, Isolability, Output, Reporter, Trace, counted

from sher3_gap.case.assembling import NEEDED
from sher3_gap.case.audit import STAGES_OF
from sher3_gap.evidence import SherEvidence
from sher3_gap.excitation import catalogue
from sher3_gap.report.drawing import robot_drawing
from sher3_gap.signals import RunSignals
from sher3_gap.stages.exact.timing import demand_in_force
from sher3_gap.stages.isolability import structure
from sher3_gap.stages.residuals import mean_force

EXACT_NEEDS = {"controller": ("command", "reference", "load"), "transport": ("command", "echo")}
"""Exact stage -> signals it is computed from."""


AT_TIP = "tip − nominal tip"
DEVIATIONS = {"transmission": "load − motor", "mechanism": AT_TIP, "structure": AT_TIP, "sensing": "reading − nominal"}
"""Stages whose deviation from the model is itself the picture -> its name."""


def recorded(runs: Sequence[RunSignals], *names: str) -> bool:
    """Return whether some run has all of these signals."""
    return any(all(getattr(run, name) is not None for name in names) for run in runs)


class SherReporter(Reporter[SherEvidence]):
    """The SHER's part of a report."""

    stages = ("controller", "transport", *STAGES[2:])  # the host computes before it sends
    flows = {**FLOWS, "sensing": "truth → wrench reading"}
    places = (*ACTUATORS, "tip", "force_sensor")
    every_stage = True
    simulated = True

    def data(self, parts: Sequence[SherEvidence]) -> str:
        """Return runs, their duration and their excitations."""
        runs = parts[0].runs
        seconds = sum(run.ticks * run.period for run in runs)
        return f"{len(runs)} runs, {seconds:.0f} s: {counted([run.excitation for run in runs])}"

    def exact_places(self, parts: Sequence[SherEvidence]) -> Mapping[str, Sequence[str]]:
        """Return the axes for transport and controller, where their topics were recorded."""
        runs = parts[0].runs
        return {stage: ACTUATORS if recorded(runs, *needs) else () for stage, needs in EXACT_NEEDS.items()}

    def purpose(self, excitation: str) -> str:
        """Return what an excitation of the standard set is for; a suffix such as `_0.8` scales it."""
        entry = catalogue().get(excitation.split("_")[0])
        return entry.purpose if entry else ""

    def isolability(self, parts: Sequence[SherEvidence]) -> Isolability:
        """Return which effects the recorded topics can tell apart."""
        topics = [topic for name, (topic, _) in STAGES_OF.items() if recorded(parts[0].runs, name)]
        return structure([NEEDED, *topics])

    def run_name(self, evidence: SherEvidence, run: int) -> str:
        """Return name, excitation and repeat."""
        signals = evidence.runs[run]
        return f"Run {signals.name} ({signals.excitation}, repeat {signals.repeat})"

    def clock(self, evidence: SherEvidence, run: int) -> Array:
        """Return the time of the residual grid, (g,) s."""
        signals = evidence.runs[run]
        return signals.stage_clock[signals.grid]

    def output(self, evidence: SherEvidence, run: int, channel: Channel) -> Output:
        """Return the measured output of a stage on the residual grid, or the name of its deviation."""
        signals = evidence.runs[run]
        if channel.stage in DEVIATIONS or signals.effort is None:
            return Output(DEVIATIONS.get(channel.stage, "measured − nominal"))
        axis = ACTUATORS.index(channel.actuator)
        if channel.stage == "drive":
            return Output("reported effort", signals.to_grid(signals.effort[:, [axis]])[:, 0])
        demand = demand_in_force(signals, evidence.robot, evidence.timing)
        force = mean_force(signals, evidence.robot, demand)[:, [axis]]
        return Output("motor force", signals.to_grid(force)[:, 0])

    def picture(self, diagnosis: Findings[SherEvidence]) -> str:
        """Return the robot with the places of the verdict lit: of its causes, or where the gap is."""
        verdict = diagnosis.verdict
        lit = {c.actuator for c in verdict.causes} or {w.actuator for w in verdict.where[:1]}
        if verdict.unexplained is not None:
            lit |= {verdict.unexplained.actuator}
        return robot_drawing(diagnosis.findings[0].evidence.robot, lit)

    def own_traces(self, diagnosis: Findings[SherEvidence]) -> tuple[list[Trace], list[Trace]]:
        """Return the picture of the transport stage where it failed, and of the tip in free runs of the simulator."""
        from sher3_gap.report.traces import free_run_trace, transport_trace

        evidence = diagnosis.findings[0].evidence
        late = transport_trace(evidence) if any(f.where.stage == "transport" for f in diagnosis.exact) else None
        tip = free_run_trace(evidence, diagnosis.verdict.causes)
        return [x for x in (late,) if x is not None], [x for x in (tip,) if x is not None]
