"""A serial arm in motion as a machine of the diagnosis."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from sher3_common.progress import Say
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.plan import SearchPlan
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.attribute.search import Left
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.finding import ExactFinding, Finding
from sher3_diagnosis.fit.fitting import Fit
from sher3_diagnosis.localise.gaps import localise
from sher3_diagnosis.machine import Policy, Rehearsal
from sher3_diagnosis.report.summary import UNJUDGED
from sher3_diagnosis.verdict import Cause, Identified
from sher3_effects import computed, pages
from sher3_machines.intake.notes import merged

from sher3_chain.chain.machine import Chain
from sher3_chain.joint.bounds import within_bounds
from sher3_chain.joint.own_unit import RECORDED, in_own_unit
from sher3_chain.joint.record import AxesRun
from sher3_chain.joint.true_force import in_true_force
from sher3_chain.manipulator.causes.confounding import GAIN, PAYLOAD, WEIGHT, confounding_notes, same_force
from sher3_chain.manipulator.causes.lateness import (
    LATE,
    acting_late,
    late_efforts,
    timing_notes,
    with_closure,
    with_late_readings,
)
from sher3_chain.manipulator.causes.links import as_sum, other_robot_notes
from sher3_chain.manipulator.causes.payload import about_its_own
from sher3_chain.manipulator.causes.plan import JOINT
from sher3_chain.manipulator.causes.search import causes_of_arm
from sher3_chain.manipulator.description import BEHIND, ManipulatorDescription
from sher3_chain.manipulator.evidence import ArmMotionEvidence, gather_arm_motion
from sher3_chain.manipulator.foreseen import foreseen
from sher3_chain.manipulator.library import joint_pages
from sher3_chain.manipulator.model import ArmModel
from sher3_chain.manipulator.readings.wrong import level_notes
from sher3_chain.power import unjudgeable
from sher3_chain.readings.level import stop_note
from sher3_chain.readings.wrong import wrong_readings
from sher3_chain.search.changes import change_notes
from sher3_chain.search.friction_in_motion import requantified
from sher3_chain.servo.laws import laws_of_servos

if TYPE_CHECKING:
    from sher3_chain.manipulator.reporter import ManipulatorReporter


IN_GAIN = (GAIN, PAYLOAD)
"""Quantities that a gain found from the data contains."""
IN_INERTIAS = (*IN_GAIN, WEIGHT)
"""Quantities that inertias found from the data contain."""


@dataclass(frozen=True)
class Manipulator(Chain[ArmMotionEvidence]):
    """A serial arm whose joints move together; its model says what force each of them needs.

    Attributes:
        model: of its rigid bodies.
    """

    described: ManipulatorDescription
    model: ArmModel
    policy = Policy(swept=True, own_level=True, absences=True)

    def library(self) -> Sequence[Effect]:
        """Return the pages of an axis and those of a joint of an arm, and those of a servo's law."""
        own = joint_pages()
        return [*own, *(e for e in pages("law") if e.id not in {x.id for x in own})]

    def effects(self, evidence: ArmMotionEvidence) -> Sequence[Effect]:
        """Return the pages that the recorded signals can show."""
        facts = {"drive", "forces"}
        if any(channel.stage == "transmission" for channel in evidence.channels):
            facts.add("load")
        if all(j.lead is not None for j in self.described.joints):
            facts.add("lead")
        known = joint_pages(facts)
        contained: tuple[str, ...] = IN_GAIN if evidence.shares or evidence.scales else ()
        contained = IN_INERTIAS if self._in_inertias and not self.described.conditions else contained
        return [e for e in known if e.scales not in contained]

    def gather(self, runs: Sequence[AxesRun]) -> Sequence[ArmMotionEvidence]:
        """Return the arm as one part; joints without an effort only move."""
        dead = {
            j.name
            for j in self.described.joints
            if all({"effort", "position"} & wrong_readings(run, j).keys() for run in runs)
        }
        judged = [j.name for j in self.described.joints if j.name not in dead and j.driven]
        return [gather_arm_motion(runs, self.described, self.model, judged)]

    def exact(
        self, runs: Sequence[AxesRun], evidence: Sequence[ArmMotionEvidence], without: Collection[str]
    ) -> list[ExactFinding]:
        """Return what departs from a servo's law, and the efforts that are late on an arm without any other gap."""
        judged = {name for part in evidence for name in part.judged}
        laws = laws_of_servos(runs, self.described, self.described.servos(judged), without)
        if any(gap.significant for part in evidence for gap in localise(part)):
            return [law for law in laws if law.closed]
        late = [] if computed(LATE).id in without else [x for part in evidence for x in late_efforts(part)]
        commanded = self.described.commanded
        return [*laws, *(replace(x, causes=[acting_late(c, commanded) for c in x.causes]) for x in late)]

    def plan(self, evidence: ArmMotionEvidence) -> SearchPlan:
        """Return how the causes of each joint are looked for."""
        return JOINT

    def causes(self, evidence: ArmMotionEvidence, candidates: Candidates, left_over: Left, say: Say) -> Attribution:
        """Choose the causes joint by joint, without and with a payload; none that identified inertias contain."""
        if self._in_inertias:
            candidates = Candidates(evidence, [e for e in candidates.effects if e.scales not in IN_INERTIAS])
        return causes_of_arm(evidence, candidates, say)

    @property
    def _in_inertias(self) -> bool:
        """Whether what multiplies the model's forces is in its inertias."""
        return self.described.inertias == "identified"

    def finished(self, candidates: Candidates, found: Fit) -> Fit:
        """Return the fit of a change with the inertia of a payload about its own centre."""
        return about_its_own(candidates, found)

    def refine(
        self, evidence: ArmMotionEvidence, causes: list[Cause], attribution: Attribution
    ) -> tuple[ArmMotionEvidence, list[Cause]]:
        """Fit friction again away from reversals; give forces of a joint with unknown gain in the recorded unit."""
        causes = requantified(evidence, attribution, causes)
        causes = within_bounds(causes, attribution.named, self.effects(evidence))
        terms = zip(map(with_late_readings, causes), (term for term, _ in attribution.named), strict=True)
        causes = [with_closure(as_sum(cause, term, self.model), term.shape) for cause, term in terms]
        weak = {j.name for j in self.described.joints if j.by_its_law}
        alike = {e.id: (e.id, *e.indistinct) for e in self.effects(evidence)}
        causes = [with_hidden(c, alike[c.effect]) if c.actuator in weak and c.effect in alike else c for c in causes]
        causes = [acting_late(cause, self.described.commanded) for cause in in_true_force(causes)]
        own, same = evidence.shares, same_force()
        return evidence, [with_hidden(in_own_unit(c, RECORDED), same) if c.actuator in own else c for c in causes]

    def remarks(self, finding: Finding[ArmMotionEvidence]) -> list[str]:
        """Say what cannot be told apart, which gains were found, and which joints were not judged."""
        evidence = finding.evidence
        silent = [j.name for j in self.described.joints if j.name not in evidence.judged]
        notes = [f"{UNJUDGED}, no usable effort or no motion: {', '.join(silent)}"] if silent else []
        turned = ", ".join(evidence.turned)
        if turned:
            notes.append(f"{turned}: effort recorded with the opposite sign: friction would give energy; it was turned")
        if evidence.gravity is not None:
            x, y, z = evidence.gravity
            notes.append(
                f"the arm hangs otherwise than its model: gravity of ({x:.2f}, {y:.2f}, {z:.2f}) m/s^2 in the frame of "
                "its base explains the efforts, and was taken; `gravity` states it"
            )
        notes += [evidence.acting] if evidence.acting else []
        if evidence.against:
            notes.append(
                f"{', '.join(evidence.against)}: recorded in the other sense than the model has: place and effort were "
                "turned; `factor: -1` states it"
            )
        if self.described.coupling is not None:
            notes.append(
                f"{BEHIND}forces, frictions and rotors are those of the motors, by their own travel; of a "
                "gear of n alone, a joint has n times the dry friction and n^2 times the viscous one and the rotor"
            )
        if self._in_inertias:
            where = "the runs of the reference" if self.described.conditions else "the data"
            notes.append(
                f"inertias identified from {where}: drive gain, weight and payload are in them, cannot be told apart "
                "and are not looked for; `sher3 gap export` writes them into a model; those that the motion tells by "
                "themselves have an interval"
            )
        notes += other_robot_notes(finding.causes)
        notes += [*stop_notes(evidence), *timing_notes(finding.causes)]
        notes += change_notes(evidence, finding.attribution, self.parted(evidence))
        levels = [x for run in evidence.runs for x in level_notes(run, self.described.joints, evidence.judged)]
        notes += merged(levels, [run.name for run in evidence.runs])
        return [*notes, *slip_notes(evidence), *gain_notes(evidence), *confounding_notes(evidence)]

    def identified(self, evidence: ArmMotionEvidence) -> Sequence[Identified]:
        """Return the inertias that were found from the data; none in a unit that nobody made newton metres."""
        own = evidence.inertias is None or evidence.shares or evidence.scales
        return [] if own or evidence.inertias is None else evidence.inertias.by_place(self.model)

    def unjudgeable(self, finding: Finding[ArmMotionEvidence]) -> dict[Channel, str]:
        """Say where the floors of all joints eat their efforts."""
        views = finding.evidence.data.views
        return unjudgeable(finding, lambda r, site, ok: views[r].effort[ok, views[r].row(site)])

    def rehearsals(self, evidence: ArmMotionEvidence, felt: Collection[str]) -> Iterator[Rehearsal]:
        """Yield the recorded motion with a known mass on the last link, where the inertias are those of the model."""
        if not self._in_inertias:
            yield from foreseen(evidence)

    def reporter(self) -> ManipulatorReporter:
        """Return the part of this machine in a report."""
        from sher3_chain.manipulator.reporter import ManipulatorReporter

        return ManipulatorReporter(self.described.model, self.model.losses is not None)


def gain_notes(evidence: ArmMotionEvidence) -> list[str]:
    """Return what was found of gains that nobody stated."""
    notes = [scale_note(evidence, joint) for joint in evidence.scales]
    if not evidence.shares:
        return notes
    notes += [
        f"{', '.join(evidence.shares)}: drive gain not stated: forces are in eu, the unit of the recorded "
        "effort; drive gain, weight and payload are confounded unless the model's inertias are right, and no payload "
        "is looked for"
    ]
    for joint, share in evidence.shares.items():
        if share.identified:
            low, high = share.interval
            text = f"{joint}: {share.value:.3g} recorded units per N m ({low:.3g} .. {high:.3g}), inertias as modelled"
            notes.append(text)
        else:
            notes.append(f"{joint}: the motion does not tell the drive gain; weight and inertia are left in the force")
    return notes


def scale_note(evidence: ArmMotionEvidence, joint: str) -> str:
    """Return what was found of a gain that differs by run."""
    each = zip(evidence.runs, evidence.scales[joint], strict=True)
    values = ", ".join(
        f"{run.name} {share.value:.4g}" if share.identified else f"{run.name} not told" for run, share in each
    )
    return (
        f"{joint}: recorded units per newton metre, run by run, inertias as modelled: {values}; drive gain, weight and "
        "payload are in them and are not looked for"
    )


def stop_notes(evidence: ArmMotionEvidence) -> list[str]:
    """Return a sentence for each joint that lay at a stop."""
    stopped = {j: np.concatenate([v.at_a_stop[:, v.row(j)] for v in evidence.records]) for j in evidence.judged}
    return [stop_note(joint, at) for joint, at in stopped.items() if at.any()]


def slip_notes(evidence: ArmMotionEvidence) -> list[str]:
    """Return a sentence for each effort in another scale than its stated gain says."""
    return [
        f"{joint}: effort is {share.value:.4g} times what the model needs: state its `factor`, or `gain: unknown`"
        for joint, share in evidence.slips.items()
    ]


def with_hidden(cause: Cause, same: Sequence[str]) -> Cause:
    """Return a cause that is one of the `same` with the others as rivals, from which no motion tells it."""
    if cause.effect not in same:
        return cause
    hidden = [e for e in same if e != cause.effect and e not in cause.rivals]
    return cause.model_copy(update={"rivals": [*cause.rivals, *hidden]})
