"""The measured effort of a joint against the law of its servo, where the model states one: judged as a command is.

The force balance says whether the arm moves as the effort says; whether the effort is what the servo was to give for
its reference is another question, and a late or weak servo answers it alone.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from sher3_common.progress import silent
from sher3_diagnosis.finding import ExactFinding, Finding
from sher3_diagnosis.flow import find
from sher3_diagnosis.judge.causes import places_of
from sher3_diagnosis.localise.gaps import component_rms
from sher3_diagnosis.quantify.closure import closure, residual_after
from sher3_diagnosis.verdict import Interval, Residual

from sher3_chain.axes.command.law import law_of_axis
from sher3_chain.axes.evidence import AxisEvidence
from sher3_chain.axes.machine import Axes
from sher3_chain.joint.description import AxesDescription, Axis, ChainDescription
from sher3_chain.joint.record import AxesRun


def laws_of_servos(
    runs: Sequence[AxesRun],
    described: ChainDescription,
    gains: Mapping[str, float],
    without: Collection[str],
) -> list[ExactFinding]:
    """Return what departs from the law of its servo, joint by joint; a joint whose effort follows it gives nothing.

    Args:
        runs: records.
        described: the machine.
        gains: joint -> N or N m per unit of its measured effort, of the joints whose servo has a stated law.
        without: ids of effects that are left out.
    """
    known = [commanded(axis) for axis in described.chain if axis.name in gains]
    if not known:
        return []
    axes = Axes(AxesDescription(kind="axes", name=described.name, time=described.time, axes=tuple(known)))
    each = ((j, law_of_axis([with_command(run, j.name, gains[j.name]) for run in runs], j)) for j in known)
    found = (find(axes, law, without, silent) for _, law in each if law is not None)
    return [exact_of(finding) for finding in found if finding.significant]


def commanded(axis: Axis) -> Axis:
    """Return a joint whose effort is the command that its law is to give."""
    signals = axis.signals.model_copy(update={"command": axis.signals.effort})
    return axis.model_copy(update={"signals": signals})


def with_command(run: AxesRun, joint: str, gain: float) -> AxesRun:
    """Return a run in which the effort of a joint, N or N m, stands as its command."""
    signals = dict(run.signals[joint])
    signals["command"] = signals["effort"] * gain
    return replace(run, signals={**run.signals, joint: signals})


def exact_of(finding: Finding[AxisEvidence]) -> ExactFinding:
    """Return a finding on one command as that of an exact stage."""
    evidence, after = finding.evidence, finding.attribution.fit
    channel, where = places_of(finding, finding.significant)[0]
    gap = finding.significant[channel]
    left = component_rms(residual_after(evidence, after, channel), gap.component)
    closed = closure(evidence, channel, evidence.null(), after) if finding.causes else Interval(value=0, low=0, high=0)
    residual = Residual(gap=left, floor=gap.floor, unit=evidence.unit(channel, gap.component))
    return ExactFinding(
        where, list(finding.causes), closed, residual, note="the effort is not what its servo's law gives"
    )
