"""The kind `arm`: a serial arm measured from outside at rest, joint zeros first, then the rest of its geometry."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from sher3_diagnosis.attribute.plan import SearchPlan
from sher3_diagnosis.attribute.stepwise import layers
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.finding import Finding
from sher3_diagnosis.machine import Policy
from sher3_diagnosis.quantify.closure import closure
from sher3_diagnosis.verdict import Cause, Interval
from sher3_machines.errors import MachineError
from sher3_machines.intake.kind import Draft
from sher3_machines.intake.tables import Tables

from sher3_static.arm.counted import counted_view, in_words
from sher3_static.arm.description import ArmDescription
from sher3_static.arm.draft import draft_postures
from sher3_static.arm.frames import set_up
from sher3_static.arm.kinematics import Arm, arm_from_table
from sher3_static.arm.reading import read_arm
from sher3_static.arm.sight import LengthSight, PoseSight, PositionSight, Sight
from sher3_static.arm.urdf import arm_from_urdf
from sher3_static.arm.words import errors_in_words, worst_postures
from sher3_static.kind import TableKind
from sher3_static.readings import Readings, joined
from sher3_static.reporter import Words
from sher3_static.table import Table, TableEvidence
from sher3_static.thresholds import FOLDS

TIP = Channel("mechanism", "tip")
"""The channel of what is measured."""


class KnownArm(NamedTuple):
    """What is known of an arm and of the instrument that measures it.

    Attributes:
        arm: nominal kinematics.
        sight: what the instrument sees.
        noise: standard deviation of a measured position or length, m.
        noise_rotation: of an orientation, rad; None where orientations are not judged.
    """

    arm: Arm
    sight: Sight
    noise: float
    noise_rotation: float | None = None


class ArmKind(TableKind[ArmDescription]):
    """Serial arms.

    Every joint has a small error of its own: a known cause may leave a share, and the next layer looks for it. What
    plain homing explains is not blamed on the machining. Rivals are not named: the notes say how far the postures tell
    joints apart.
    """

    name, description = "arm", ArmDescription
    reader = staticmethod(read_arm)
    stored = ("joints",)
    written_for = ("arm",)
    policy = Policy(swept=True, carried=True, own_level=True, absences=True)
    search = SearchPlan(layers=True)
    words = Words(
        rows="{n} postures, measured from outside",
        whole="All postures",
        row="posture",
        parts="postures",
        end="measured pose",
        flows={"mechanism": "joint positions → pose"},
        residual={"mechanism": "measured − nominal pose"},
    )

    def known_by(self, description: ArmDescription) -> KnownArm:
        """Return the arm; raises MachineError for a URDF that cannot be read or has no such chain."""
        arm = (
            arm_from_table(description.joints, description.tip)
            if description.urdf is None
            else arm_from_urdf(Path(description.urdf), description.base_link, description.tip_link)
        )
        seen: dict[str, Sight] = {"poses": PoseSight(), "positions": PositionSight(), "lengths": LengthSight()}
        sight = next(x for name, x in seen.items() if getattr(description, name) is not None)
        return KnownArm(arm, sight, description.noise, description.noise_rotation)

    def draft(self, path: Path, tables: Tables, rate: float | None, model: Path | None) -> Draft | None:
        """Draft an arm of postures where a model and no clock is given; None of any other table."""
        return draft_postures(path, tables, model) if model is not None and rate is None else None

    def tables(self, known: KnownArm, runs: Sequence[Readings]) -> Sequence[Table]:
        """Return all postures as one table with the frames fitted to all; a tenth is held out in turn.

        Raises:
            MachineError: the arm has another number of joints, or the postures do not tell the frames.
        """
        rows = joined(runs)
        q, measured, names = rows["joints"], rows[known.sight.column], known.arm.names
        if q.shape[1] != len(names):
            what, remedy = "joint positions do not fit the arm", "correct the table"
            raise MachineError(what, value=q.shape[1], limit=len(names), remedy=remedy)
        floor = known.sight.floor(known.noise, known.noise_rotation)
        view, counts = counted_view(known.arm, q, measured, rows["run"], floor, known.sight)
        table = Table(
            name="arm",
            channel=TIP,
            view=view,
            residual=known.sight.error(view.pose, measured),
            floor=floor,
            spread=known.sight.error(np.repeat(view.pose[:1], len(q), axis=0), measured).std(axis=0),
            part=np.arange(len(q)) % FOLDS,
            run=rows["run"],
            unit="m",
            pages=self.library(),
            places={"joint": known.arm.turning},
            rotary=frozenset(known.arm.turning),
            free=set_up(view, "identified"),
            zeros=set_up(view, "moved"),
            known=in_words(known.arm, counts),
        )
        return [table]

    def notes_on(self, finding: Finding[TableEvidence]) -> list[str]:
        """Say how far held-out postures are off, layer by layer, and where what is left lies."""
        evidence, steps = finding.evidence, finding.attribution.steps
        folds = f"{evidence.table.view.rows} postures, one in {FOLDS} held out in turn"
        notes = [*evidence.table.known, f"{folds}; floor: the stated noise of a measured pose"]
        labels = ["measurement frames only"]
        for layer, after in zip(layers(evidence.table.pages), steps[1:], strict=False):
            count = len(after.terms) - len(evidence.nuisance)
            labels.append(f"with {' and '.join(e.id for e in layer)} ({count} in all)")
        notes += [f"{label}: {errors_in_words(evidence, fit)}" for label, fit in zip(labels, steps, strict=True)]
        found, first = finding.attribution, len(evidence.nuisance)
        small = [f"{t.effect.id} of {t.site}" for t in found.fit.terms[first : found.nuisance]]
        if small:
            notes.append(f"fitted and not named, since their size may be zero: {', '.join(small)}")
        return notes + ([worst_postures(evidence, found.fit)] if finding.left else [])

    def end_to_end(self, findings: Sequence[Finding[TableEvidence]], causes: Sequence[Cause]) -> Interval | None:
        """Return the closure of the measured pose, which is the end of the chain."""
        evidence = findings[0].evidence
        return closure(evidence, TIP, evidence.null(), findings[0].attribution.fit)


KIND = ArmKind()
