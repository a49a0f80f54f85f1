"""The diagnosis of a machine's case: the engine's localisation, attribution and closures, axis by axis."""

from __future__ import annotations

import importlib.metadata
import time
from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from pathlib import Path
from typing import cast

import numpy as np

from sher3_gap.attribute import Attribution, attribute
from sher3_gap.channels import Channel
from sher3_gap.diagnose import left_over
from sher3_gap.evidence import Evidence
from sher3_gap.fitting import Fit, fit
from sher3_gap.library import LIBRARY
from sher3_gap.localise import gap_of, localise
from sher3_gap.machines.arm_diagnose import diagnose_arm
from sher3_gap.machines.axis_evidence import gather_axis
from sher3_gap.machines.case import load_axes
from sher3_gap.machines.describe import regime_of, remainder_of
from sher3_gap.machines.description import ArmMachine, AxesMachine, Axis
from sher3_gap.machines.effects import MachineCandidates, effects_on, polished
from sher3_gap.machines.finding import AxisFinding, unit_of
from sher3_gap.machines.intake import AxesRun
from sher3_gap.machines.limits import limit_finding
from sher3_gap.machines.replay import refine_free, replay_closure
from sher3_gap.machines.rest import rest_loss
from sher3_gap.quantify import closure, excess, parameters, residual_after
from sher3_gap.verdict import Cause, Closure, Interval, NextExperiment, Residual, Status, Unexplained, Verdict, Where

Say = Callable[[str], None]
NO_REPEATS = (
    "no repeats: floors are the residuals' innovations or the sensors' resolution, and intervals come from blocks of a "
    "record: what differs from day to day is in neither"
)


@dataclass(frozen=True)
class MachineDiagnosis:
    """A verdict with what was found on each axis; an arm has no axes."""

    verdict: Verdict
    findings: list[AxisFinding]


def diagnose_machine(case: Path, without: Collection[str] = (), say: Say = lambda _: None) -> MachineDiagnosis:
    """Diagnose the case of another machine.

    Raises:
        MachineError: the case cannot be read, or its data carry no answer.
    """
    started = time.perf_counter()
    machine, runs, arms = load_axes(Path(case))
    findings: list[AxisFinding] = []
    if isinstance(machine, ArmMachine):
        verdict = diagnose_arm(machine, arms, without, say)
    else:
        verdict, findings = diagnose_axes(machine, runs, without, say)
    versions = {p: importlib.metadata.version(p) for p in ("sher3", "numpy", "scipy")}
    verdict = verdict.model_copy(update={"seconds": time.perf_counter() - started, "versions": versions})
    return MachineDiagnosis(verdict, findings)


def diagnose_axes(
    machine: AxesMachine, runs: list[AxesRun], without: Collection[str], say: Say
) -> tuple[Verdict, list[AxisFinding]]:
    """Diagnose every axis of a chain and gather the answers."""
    notes = [n for r in runs for n in r.notes]
    if not (machine.repeats and len(runs) > 1):
        notes.append(NO_REPEATS)
    limits = [f for a in machine.axes if (f := limit_finding(runs, a, without)) is not None]
    findings = []
    for axis in machine.axes:
        say(f"axis {axis.name}")
        findings.append(_axis(runs, axis, machine.repeats and len(runs) > 1, without, say))
    notes += [n for f in findings for n in f.notes]
    where = [x.where for x in limits] + _where(findings)
    causes = [x.cause for x in limits] + [c for f in findings for c in f.causes]
    if not where:
        return Verdict(status="no_gap", notes=notes), findings
    order = np.argsort([-w.gap / max(w.floor, 1e-300) for w in where], kind="stable")
    left = [f for f in findings if f.open]
    unexplained = _unexplained(left[0]) if left else None
    first = where[order[0]]
    status, experiment = _status(causes, unexplained)
    owner = next(
        (f for f in findings if f.axis.name == first.actuator and any(c.stage == first.stage for c in f.gaps)), None
    )
    held, rest = (None, None) if owner is None else _held_out(owner, first.stage)
    limit = next((x for x in limits if x.where is first), None)
    if limit is not None:
        held, rest = limit.cause.closure, limit.residual
    tips = [f.replay for f in findings if f.replay is not None]
    verdict = Verdict(
        status=status,
        where=[where[i] for i in order],
        causes=sorted(causes, key=lambda c: -c.closure.value),
        closure=Closure(stage=held, tip=tips[0].closure if tips else None),
        residual=rest,
        unexplained=unexplained,
        next_experiment=experiment,
        notes=notes,
    )
    return verdict, findings


def _axis(runs: list[AxesRun], axis: Axis, repeats: bool, without: Collection[str], say: Say) -> AxisFinding:
    found = gather_axis(runs, axis, repeats)
    evidence = cast(Evidence, found)
    gaps = {g.channel: g for g in localise(evidence) if g.significant}

    def significant(current: Fit) -> dict[Channel, float]:
        """A short description leaves several plain causes out: the search goes on down to the floor."""
        out = {}
        for channel in gaps:
            gap = gap_of(evidence, channel, residual_after(evidence, current, channel))
            if gap is not None and gap.significant:
                out[channel] = max(1.0, excess(evidence, channel, current))
        return out

    candidates = MachineCandidates(evidence, without, listed=effects_on(axis, without))
    result = attribute(evidence, significant, candidates, say)
    if gaps and rest_loss(found, result.fit) > 0.0:
        candidates.dry_first = True
        other = attribute(evidence, significant, candidates, say)
        result = min((result, other), key=lambda a: a.fit.total + rest_loss(found, a.fit))
    result = replace(result, fit=polished(candidates, result.fit))
    causes = [_cause(evidence, result, i) for i in range(len(result.fit.terms))]
    refined = refine_free(runs, axis, found, causes)
    causes, found = refined.causes, replace(found, mass=refined.mass)
    finding = AxisFinding(axis, found, gaps, result, causes, left_over(evidence, gaps, result.fit))
    if found.mass_interval is not None:
        low, high = found.mass_interval
        unit = "kg" if axis.motion == "linear" else "kg m^2"
        finding.notes.append(f"{axis.name}: mass identified as {found.mass:.5g} {unit} ({low:.5g} .. {high:.5g})")
    finding.notes += _structure(axis)
    finding.replay = replay_closure(runs, axis, found, causes) if gaps else None
    if finding.replay is not None:
        finding.notes.append(finding.replay.note)
    return finding


def _structure(axis: Axis) -> list[str]:
    """What the recorded signals cannot tell, said before any fit."""
    out = []
    if axis.signals.load is None:
        out.append(f"{axis.name}: one encoder: backlash and compliance behind it cannot be seen and are not looked for")
    if axis.command_law.kind == "position":
        out.append(f"{axis.name}: force not recorded: forces are given in units of the servo's stiffness")
    return out


def _cause(evidence: Evidence, attribution: Attribution, index: int) -> Cause:
    term = attribution.fit.terms[index]
    without = fit(evidence.data, [t for j, t in enumerate(attribution.fit.terms) if j != index])
    channel = max(term.channels, key=lambda c: excess(evidence, c, without) - excess(evidence, c, attribution.fit))
    return Cause(
        effect=term.effect.id,
        family=term.effect.family,
        stage=term.effect.stage,
        actuator=term.site,
        parameters=parameters(evidence, attribution.fit, index),
        closure=closure(evidence, channel, without, attribution.fit),
        rivals=list(dict.fromkeys(f.terms[-1].effect.id for f in attribution.rivals[index])),
    )


def _where(findings: list[AxisFinding]) -> list[Where]:
    return [
        Where(
            stage=channel.stage,
            actuator=f.axis.name,
            gap=gap.gap,
            floor=gap.floor,
            unit=unit_of(f.axis, channel.stage),
            regime=regime_of(f.evidence, channel),
            confidence=float(1.0 - np.exp(-gap.power)),
        )
        for f in findings
        for channel, gap in f.gaps.items()
    ]


def _status(causes: list[Cause], unexplained: Unexplained | None) -> tuple[Status, NextExperiment | None]:
    crossed = [c for c in causes if {LIBRARY[r].family for r in c.rivals} - {c.family}]
    experiment = None
    if crossed:
        experiment = NextExperiment(
            excitation="steps",
            purpose="steps and reversals of several amplitudes and speeds tell the rivals apart",
            separates=[crossed[0].effect, *crossed[0].rivals],
            predicted_separation=None,
        )
    if unexplained is not None:
        return "outside_library", experiment
    return ("under_excited" if experiment else "attributed"), experiment


def _unexplained(finding: AxisFinding) -> Unexplained:
    channel = max(finding.open, key=lambda c: finding.open[c])
    text = remainder_of(finding.evidence, channel, finding.attribution.fit)
    return Unexplained(stage=channel.stage, actuator=finding.axis.name, signature=text)


def _held_out(finding: AxisFinding, stage: str) -> tuple[Interval, Residual]:
    evidence = cast(Evidence, finding.evidence)
    channel = next(c for c in finding.gaps if c.stage == stage)
    after = finding.attribution.fit
    gap = gap_of(evidence, channel, residual_after(evidence, after, channel))
    assert gap is not None
    held = closure(evidence, channel, fit(evidence.data, []), after)
    return held, Residual(gap=gap.gap, floor=gap.floor, unit=unit_of(finding.axis, stage))
