"""A serial arm as a machine of the diagnosis: joint zeros first, then the rest of its geometry."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.rivals import Attribution, without_term
from sher3_diagnosis.attribute.search import Left, Say
from sher3_diagnosis.attribute.stepwise import grow
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.finding import Finding
from sher3_diagnosis.fit.fitting import Fit
from sher3_diagnosis.machine import Machine
from sher3_diagnosis.quantify.closure import closure
from sher3_diagnosis.verdict import Cause, Interval
from sher3_effects import pages
from sher3_effects.geometry.encoder_offset import JointOffset
from sher3_effects.geometry.link_length_error import JointPlace
from sher3_effects.geometry.rail_tilt import JointTilt
from sher3_machines.thresholds import FOLDS, WORST

from sher3_static.arm.evidence import ArmEvidence, gather_arm
from sher3_static.arm.frames import TIP
from sher3_static.arm.kinematics import Arm
from sher3_static.arm.record import ArmData

if TYPE_CHECKING:
    from sher3_static.arm.reporter import ArmReporter

LAYERS = ((JointOffset.id,), (JointPlace.id, JointTilt.id))
"""Effects in the order they are looked for: what homing alone explains is not blamed on the machining."""
MM = 1e3
"""Millimetres in a metre."""


@dataclass(frozen=True)
class SerialArm(Machine[ArmData, ArmEvidence]):
    """An arm whose poses were measured from outside.

    The postures were chosen by whoever calibrated the arm, and every joint has a small error of its own: nothing asks
    for a cause to be of one size in all of them, and a slight gap is no spill-over.

    Attributes:
        arm: nominal kinematics.
        noise: standard deviation of a measured position, m.
        noise_rotation: of an orientation, rad; None where orientations are not judged.
    """

    arm: Arm
    noise: float
    noise_rotation: float | None = None

    def library(self) -> Sequence[Effect]:
        """Return the pages of geometric errors of a joint."""
        return pages("arm")

    def gather(self, runs: Sequence[ArmData]) -> Sequence[ArmEvidence]:
        """Return the arm as one part; raises MachineError where postures do not fit the arm or tell no frames."""
        return [gather_arm(self.arm, runs, self.noise, self.noise_rotation)]

    def attribute(self, evidence: ArmEvidence, candidates: Candidates, left_over: Left, say: Say) -> Attribution:
        """Grow the fit layer by layer where there is a gap.

        Rivals are not named: each of many small errors could be another joint's, and the notes say how far the postures
        tell them apart.
        """
        current = evidence.null()
        steps = [current]
        for layer in LAYERS if left_over(current) else ():
            say(f"fitting {', '.join(layer)}")
            current = grow(candidates, [e for e in candidates.effects if e.id in layer], current)
            steps.append(current)
        terms = range(len(current.terms))
        explained = tuple(without_term(evidence, current, i).total - current.total for i in terms)
        return Attribution(
            current,
            rivals=tuple(() for _ in terms),
            explained=explained,
            nuisance=len(evidence.nuisance),
            steps=tuple(steps),
        )

    def remarks(self, finding: Finding[ArmEvidence]) -> list[str]:
        """Say how far held-out postures are off, layer by layer, and where what is left lies."""
        evidence, steps = finding.evidence, finding.attribution.steps
        folds = f"{evidence.postures} postures, one in {FOLDS} held out in turn"
        notes = [f"{folds}; floor: the stated noise of a measured pose"]
        labels = ["measurement frames only"]
        for layer, after in zip(LAYERS, steps[1:], strict=False):
            labels.append(f"with {' and '.join(layer)} ({len(after.terms) - len(evidence.nuisance)} in all)")
        notes += [f"{label}: {errors_in_words(evidence, fit)}" for label, fit in zip(labels, steps, strict=True)]
        return notes + ([worst_postures(evidence, finding.attribution.fit)] if finding.left else [])

    def reporter(self) -> ArmReporter:
        """Return the part of this machine in a report."""
        from sher3_static.arm.reporter import ArmReporter

        return ArmReporter()

    def end_to_end(self, findings: Sequence[Finding[ArmEvidence]], causes: Sequence[Cause]) -> Interval | None:
        """Return the closure of the measured pose, which is the end of the chain."""
        evidence = findings[0].evidence
        return closure(evidence, TIP, evidence.null(), findings[0].attribution.fit)


def errors_in_words(evidence: ArmEvidence, after: Fit) -> str:
    """Return the position error under a fit, of held-out postures and of those fitted."""
    held = MM * np.linalg.norm(evidence.held_out(after), axis=1)
    seen = MM * np.linalg.norm(evidence.seen(after), axis=1)
    text = f"position error on held-out postures {held.mean():.2f} mm mean, {held.max():.1f} mm worst"
    return f"{text} ({seen.mean():.2f} mm on those fitted)"


def worst_postures(evidence: ArmEvidence, after: Fit) -> str:
    """Return how much of what is left the worst postures hold: a few bad measurements, or all of the workspace."""
    square = np.sort(np.sum(evidence.held_out(after) ** 2, axis=1))
    worst = float(square[-max(1, len(square) // WORST) :].sum() / square.sum())
    mean = MM * float(np.sqrt(square).mean())
    return f"{mean:.2f} mm mean left; the worst {1 / WORST:.0%} of the postures hold {worst:.0%} of its power"
