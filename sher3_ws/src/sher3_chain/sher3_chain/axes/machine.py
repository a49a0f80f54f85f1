"""A chain of axes as a machine of the diagnosis."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from sher3_diagnosis.attribute.plan import SearchPlan
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.finding import ExactFinding, Finding
from sher3_diagnosis.machine import Policy, Rehearsal
from sher3_diagnosis.verdict import Cause, Interval
from sher3_effects import computed, pages
from sher3_effects.view import NominalAxis
from sher3_machines.errors import MachineError
from sher3_machines.thresholds import BLOCKS

from sher3_chain.axes.causes.confounded_laws import indistinct_notes, with_indistinct, with_second_pole
from sher3_chain.axes.causes.detection_limits import one_encoder_note
from sher3_chain.axes.causes.plan import AXIS
from sher3_chain.axes.causes.refine import refine_free
from sher3_chain.axes.command.law import LAW, is_law, law_of_axis
from sher3_chain.axes.evidence import AxisEvidence, gather_axis, levels_of, signal_of
from sher3_chain.axes.foreseen import foreseen
from sher3_chain.axes.limits import LIMIT, limit_finding
from sher3_chain.axes.replay import replay
from sher3_chain.chain.machine import Chain
from sher3_chain.chain.view import held_beside
from sher3_chain.joint.bounds import within_bounds
from sher3_chain.joint.conditions import Condition
from sher3_chain.joint.description import AxesDescription, Axis, Gravity
from sher3_chain.joint.own_unit import in_own_unit, own_unit_note, renamed
from sher3_chain.joint.record import AxesRun
from sher3_chain.joint.true_force import in_true_force
from sher3_chain.power import unjudgeable
from sher3_chain.readings.level import stop_note
from sher3_chain.readings.wrong import without_wrong, wrong_readings
from sher3_chain.search.changes import change_notes
from sher3_chain.search.friction_in_motion import requantified, with_unseen

if TYPE_CHECKING:
    from sher3_chain.axes.reporter import AxesReporter


@dataclass(frozen=True)
class Axes(Chain[AxisEvidence]):
    """Axes that move independently of each other."""

    described: AxesDescription
    policy = Policy(swept=True, own_level=True, absences=True)

    def library(self) -> Sequence[Effect]:
        """Return the pages for these kinds of axes, and that of the limit, which is read off without a fit."""
        axes = self.described.axes
        kinds = sorted({kind_of(axis) for x in axes for axis in (x, x.tracked) if axis is not None}, reverse=True)
        any_axis = NominalAxis(np.inf, 0.0, 0.0, 0.0, weighed=any(axis.swings for axis in self.described.axes))
        known = [page.on(any_axis) for kind in kinds for page in pages(kind)]
        return [*known, *pages("law"), computed(LIMIT)]

    def of(self, evidence: AxisEvidence) -> Axes:
        """Return these axes, or their commands."""
        return Commands(self.described) if is_law(evidence) else self

    def effects(self, evidence: AxisEvidence) -> Sequence[Effect]:
        """Return the pages that can show in what was recorded of an axis."""
        axis = evidence.axis
        nominal = NominalAxis(evidence.mass, axis.viscous, 0.0, 0.0, weighed=axis.swings)
        return [page.on(nominal) for page in pages(kind_of(axis), facts_of(axis))]

    def gather(self, runs: Sequence[AxesRun]) -> Sequence[AxisEvidence]:
        """Compute residuals and floors of every axis; raises MachineError where an unknown mass cannot be found."""
        parts: list[AxisEvidence] = []
        held = held_axes(runs, self.described.axes)
        for axis in self.described.axes:
            heard = [without_wrong(run, axis) for run in runs]
            if all("position" in run.signals[axis.name] for run in heard):
                parts.append(gather_axis(heard, axis, self.repeated(runs), held.get(axis.name, "")))
                law = law_of_axis(heard, axis)
                parts += [law] if law is not None else []
        if not parts:
            raise MachineError("no axis can be judged", value="every position is dead", remedy="connect the encoders")
        limited = any(limit_finding(runs, axis) for axis in self.described.axes)
        if not limited and not any(part.channels for part in parts):
            raise nothing_judged(parts, runs)
        return parts

    def exact(
        self, runs: Sequence[AxesRun], evidence: Sequence[AxisEvidence], without: Collection[str]
    ) -> list[ExactFinding]:
        """Look for drives at their limit."""
        if computed(LIMIT).id in without:
            return []
        found = (limit_finding(part.runs, part.axis) for part in evidence if self.of(part) is self)
        return [limit for limit in found if limit is not None]

    def plan(self, evidence: AxisEvidence) -> SearchPlan:
        """Return how the causes of an axis are looked for."""
        return AXIS

    def refine(
        self, evidence: AxisEvidence, causes: list[Cause], attribution: Attribution
    ) -> tuple[AxisEvidence, list[Cause]]:
        """Refine mass and forces of a free axis on its simulated motion, of a driven one away from its reversals."""
        free, servo, own = evidence.axis.free, evidence.axis.servo, evidence.axis.own_unit
        causes = causes if free else requantified(evidence, attribution, causes)
        causes = causes if free or servo else with_unseen(evidence, attribution, causes)
        causes = within_bounds(causes, attribution.named, self.effects(evidence))
        if free:
            return refine_free(evidence, causes)
        causes = with_second_pole(with_indistinct(causes)) if servo else in_true_force(causes)
        return evidence, [in_own_unit(cause, own) for cause in causes] if own else causes

    def rehearsals(self, evidence: AxisEvidence, felt: Collection[str]) -> Iterator[Rehearsal]:
        """Yield the recorded motions at other speeds, and with a known mass."""
        yield from foreseen(evidence)

    def remarks(self, finding: Finding[AxisEvidence]) -> list[str]:
        """Say which mass was found, what the recorded signals cannot tell, and how the axis runs again."""
        again = replay(finding.evidence, finding.causes) if finding.significant else None
        changes = change_notes(finding.evidence, finding.attribution, self.parted(finding.evidence))
        not_judged = finding.evidence.not_judged
        changes += finding.evidence.notes
        own = finding.evidence.axis.own_unit
        changes += [own_unit_note(finding.evidence.axis.name, own)] if own else []
        changes += [f"{not_judged}: its force balance is not judged"] if not_judged else []
        return [
            *changes,
            *mass_notes(finding.evidence),
            *stop_notes(finding.evidence),
            *blind_spots(finding),
            *carried_by_others(finding, self.described.axes),
            *([again.note] if again else []),
        ]

    def unjudgeable(self, finding: Finding[AxisEvidence]) -> dict[Channel, str]:
        """Say where the floor of an axis without a gap eats its force, or what a servo was asked."""
        return unjudgeable(finding, partial(signal_of, finding.evidence))

    def reporter(self) -> AxesReporter:
        """Return the part of this machine in a report."""
        from sher3_chain.axes.reporter import AxesReporter

        return AxesReporter()

    def end_to_end(self, findings: Sequence[Finding[AxisEvidence]], causes: Sequence[Cause]) -> Interval | None:
        """Return the closure of the position of the first axis that can be run again."""
        moved = (f for f in findings if f.significant and self.of(f.evidence) is self)
        runs_again = (replay(f.evidence, f.causes) for f in moved)
        return next((again.closure for again in runs_again if again is not None), None)


@dataclass(frozen=True)
class Commands(Axes):
    """The commands of the axes, each against its law: parts beside those of the axes themselves."""

    def effects(self, evidence: AxisEvidence) -> Sequence[Effect]:
        """Return the pages for commands."""
        return pages("law")

    def plan(self, evidence: AxisEvidence) -> SearchPlan:
        """Return how the causes of a command are looked for."""
        return LAW

    def parted(self, evidence: AxisEvidence) -> list[tuple[Condition, frozenset[int]]]:
        """Return no condition: a law is stated once for all."""
        return []

    def refine(
        self, evidence: AxisEvidence, causes: list[Cause], attribution: Attribution
    ) -> tuple[AxisEvidence, list[Cause]]:
        """Return both as they are: a law is exact."""
        return evidence, causes

    def rehearsals(self, evidence: AxisEvidence, felt: Collection[str]) -> Iterator[Rehearsal]:
        """Yield none: what a law asks for is computed, not recorded again."""
        yield from ()

    def remarks(self, finding: Finding[AxisEvidence]) -> list[str]:
        """Say whether the command is what its law states."""
        return law_notes(finding)


def held_axes(runs: Sequence[AxesRun], axes: Sequence[Axis]) -> dict[str, str]:
    """Return driven axis -> why its force balance says nothing, of those that are held while another one moves far.

    What such an axis moves by is how its controller gives way to the others, or a rest of numbers, and its force is the
    answer: both follow laws that are none of the axis.
    """
    travels = [max(float(np.ptp(run.signals[a.name].get("position", [0.0]))) for run in runs) for a in axes]
    why = "it is held while others move far, and its force answers them"
    remedy = "describe an arm as `kind: manipulator`, or take out what it is no part of"
    return {
        axis.name: f"axis {axis.name}: moves by {travel:.2g} {axis.unit_of_position}: {why}; {remedy}"
        for axis, travel, held in zip(axes, travels, held_beside(travels, [a.motion for a in axes]), strict=True)
        if held and axis.driven and not axis.servo
    }


def nothing_judged(parts: Sequence[AxisEvidence], runs: Sequence[AxesRun]) -> MachineError:
    """Return the refusal of records in which there is nothing to compare, with what each axis lacks."""
    said = []
    for part in parts:
        dead = [what for run in runs for what in wrong_readings(run, part.axis).values()]
        flat = levels_of([view.run for view in part.records], part.axis)
        said.append(
            "; ".join([*flat[:1], part.not_judged or (dead[0] if dead else f"{part.axis.name}: {missing(part)}")])
        )
    remedy = (
        "correct what is named, or record the reference of a servo, the effort of a driven axis, or a second encoder"
    )
    return MachineError(f"no axis can be judged: {'; '.join(said[:3])}", value=f"{len(parts)} axes", remedy=remedy)


def missing(part: AxisEvidence) -> str:
    """Return what is missing for an axis to be judged."""
    travel = max(float(np.ptp(view.run.motor)) for view in part.records)
    if travel <= part.axis.encoder_resolution:
        return f"does not move by more than one count, {part.axis.encoder_resolution:.3g} {part.axis.unit_of_position}"
    if not all(len(view.run.grid) < 2 * BLOCKS for view in part.records):
        if part.axis.driven and part.axis.mass is None:
            return "its force is recorded and its `mass` is not stated: state it, or `mass: unknown`"
        if part.axis.free and part.axis.mass is None:
            return "nothing drives it: of a body that is let go state `mass`; 1.0 tells its forces for each kg (kg m^2)"
        return "nothing was recorded that its position can be compared with"
    longest = max((view.run for view in part.records), key=lambda run: run.ticks * run.period)
    return (
        f"the records are too short, {longest.ticks * longest.period:.3g} s at {1.0 / longest.period:.3g} Hz "
        "(is `time` in that unit? `override: true` corrects a header)"
    )


def kind_of(axis: Axis) -> str:
    """Return the kind of machine that pages for an axis are written for."""
    return "servo" if axis.servo else "axis"


def facts_of(axis: Axis) -> set[str]:
    """Return what is known of an axis, as pages ask for it."""
    known = {
        "lead": axis.lead is not None,
        "no_lead": axis.lead is None,
        "load": axis.signals.load is not None,
        "alone": axis.signals.load is None and axis.encoder_at == "motor",
        "behind": axis.signals.load is None and axis.encoder_at == "load",
        "temperature": axis.signals.temperature is not None,
        "applied": axis.signals.applied is not None,
        "mass": isinstance(axis.mass, float),
        "drive": not axis.free,
        "held": axis.servo and not axis.summed,
        "asked speed": axis.servo and axis.summed,
        "forces": isinstance(axis.mass, float) or axis.gravity != Gravity() or axis.signals.nominal_effort is not None,
    }
    return {fact for fact, is_known in known.items() if is_known}


def law_notes(finding: Finding[AxisEvidence]) -> list[str]:
    """Return whether the command is what its law states."""
    axis = finding.evidence.axis
    floors = [float(x[0]) for floors in finding.evidence.floors for x in floors.values()]
    if finding.significant or not floors:
        return list(finding.evidence.notes)
    held = f"{axis.name}: its command is what the stated law asks for, within {np.median(floors):.2g}"
    return [held, *finding.evidence.notes]


def mass_notes(evidence: AxisEvidence) -> list[str]:
    """Return the mass that was identified, with its interval."""
    if evidence.mass_interval is None:
        return []
    axis, (low, high) = evidence.axis, evidence.mass_interval
    unit = renamed("kg" if axis.motion == "linear" else "kg*m^2", axis.own_unit) if axis.own_unit else "kg"
    unit = "kg m^2" if unit == "kg" and axis.motion == "rotary" else unit
    behind = max(view.load_mass for view in evidence.records)
    share = f", of which {behind:.3g} move with the second encoder" if behind else ""
    return [f"{axis.name}: mass identified as {evidence.mass:.5g} {unit} ({low:.5g} .. {high:.5g}){share}"]


def stop_notes(evidence: AxisEvidence) -> list[str]:
    """Return a sentence on an axis that lay at a stop of its stated range."""
    at = np.concatenate([view.at_a_stop for view in evidence.records])
    return [stop_note(evidence.axis.name, at)] if at.any() else []


def carried_by_others(finding: Finding[AxisEvidence], axes: Sequence[Axis]) -> list[str]:
    """Return that joints of one arm carry each other, where a driven axis of several that turn has a gap left."""
    turning = [axis.name for axis in axes if axis.motion == "rotary" and axis.driven]
    name = finding.evidence.axis.name
    if not finding.left or name not in turning or len(turning) < 2:
        return []
    return [
        f"{name}: axes are judged one by one; joints of an arm carry each other: describe it as `kind: manipulator` "
        "with its URDF or MJCF"
    ]


def blind_spots(finding: Finding[AxisEvidence]) -> list[str]:
    """Return what the recorded signals cannot tell."""
    axis = finding.evidence.axis
    out = [] if axis.signals.load is not None else [one_encoder_note(finding.evidence, finding.attribution.fit)]
    if axis.servo:
        unread = axis.signals.effort is not None and not finding.evidence.not_judged
        why = "its effort is not looked at (`command_law: {kind: force}` does)" if unread else "force not recorded"
        out.append(f"{axis.name}: {why}: forces are given in units of the servo's stiffness")
        out += indistinct_notes(axis.name, finding.causes, axis.unit_of_position)
    return [said for said in out if said]
