"""What every chain of joints does alike as a machine: its notes on the data, and causes under several conditions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

import numpy as np
from sher3_common.progress import Say
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.attribute.search import Left
from sher3_diagnosis.channel import Array
from sher3_diagnosis.fit.fitting import Fit
from sher3_diagnosis.judge.left_over import down_to_floor
from sher3_diagnosis.localise.readings import noise_in
from sher3_diagnosis.machine import Machine
from sher3_diagnosis.verdict import Noise
from sher3_machines.drafting.guesses import count_of
from sher3_machines.intake.notes import merged

from sher3_chain.chain.evidence import ChainEvidence
from sher3_chain.joint.conditions import Condition, conditions_of, confounded_conditions, reference_runs
from sher3_chain.joint.description import Axis, ChainDescription
from sher3_chain.joint.record import READINGS, AxesRun
from sher3_chain.readings.wrong import wrong_readings
from sher3_chain.search.changes import contrasted, select_runs

E = TypeVar("E", bound=ChainEvidence)
NO_REPEATS = (
    "no repeats: floors are the residuals' innovations or the sensors' resolution, and intervals come from blocks of a "
    "record: what differs from day to day is in neither"
)


@dataclass(frozen=True)
class Chain(Machine[AxesRun, E]):
    """Joints that were recorded together.

    A description of a few lines leaves several plain causes out, so that the search goes on down to the floor.

    Attributes:
        described: nominal constants of every joint, and what was recorded of it.
    """

    described: ChainDescription

    def causes(self, evidence: E, candidates: Candidates, left_over: Left, say: Say) -> Attribution:
        """Choose the causes of one part, recorded under one condition; default by its plan alone."""
        return super().attribute(evidence, candidates, left_over, say)

    def finished(self, candidates: Candidates, found: Fit) -> Fit:
        """Return the fit of a change between conditions, improved by what its search does not do; default as it is."""
        return found

    def audit(self, runs: Sequence[AxesRun]) -> list[str]:
        """Return what was done to the data, which channels are wrong, and whether floors are known from repeats."""
        notes = [note for run in runs for note in run.notes]
        notes += [
            note for run in runs for joint in self.described.chain for note in wrong_readings(run, joint).values()
        ]
        notes = merged(notes, [run.name for run in runs]) + confounded_conditions(self.conditions(runs))
        return notes if self.repeated(runs) else [*notes, NO_REPEATS]

    def attribute(self, evidence: E, candidates: Candidates, left_over: Left, say: Say) -> Attribution:
        """Choose the causes of one part, and what changed between the conditions of its runs."""
        parted = self.parted(evidence)
        if not parted:
            return self.causes(evidence, candidates, left_over, say)
        kept = reference_runs([c for c, _ in parted], [run.name for run in evidence.runs])
        reference = select_runs(evidence, evidence.views_of(kept))
        left = partial(down_to_floor, reference.channels, reference)
        common = self.causes(reference, Candidates(reference, candidates.effects), left, say)
        say("contrasting conditions")
        return contrasted(evidence, common, candidates.effects, parted, self.finished)

    def parted(self, evidence: E) -> list[tuple[Condition, frozenset[int]]]:
        """Return every condition with the identities of the views of its runs."""
        return [(c, evidence.views_of(c.runs)) for c in self.conditions(evidence.runs)]

    def conditions(self, runs: Sequence[AxesRun]) -> list[Condition]:
        """Return the conditions that differ from that of the first run."""
        return conditions_of(self.described.conditions, [run.name for run in runs])

    def noise(self, runs: Sequence[AxesRun]) -> list[Noise]:
        """Return the noise of every reading that changes; a place that is the sum of a speed has none of its own."""
        return [
            x
            for joint in self.described.chain
            for x in noise_of_joint(joint, [run.signals[joint.name] for run in runs])
        ]

    def repeated(self, runs: Sequence[AxesRun]) -> bool:
        """Return whether the runs are repeats of one motion."""
        return self.described.repeats and len(runs) > 1


def noise_of_joint(joint: Axis, records: Sequence[Mapping[str, Array]]) -> list[Noise]:
    """Return the noise of every reading of a joint that changes.

    A place that is the sum of a speed, or an effort that follows from a law, is no reading.

    Args:
        joint: as described.
        records: signal -> readings (n,), of each record.
    """
    gain, force = joint.effort_as_read
    out = []
    for reading in READINGS:
        scale, unit = (gain, force) if reading == "effort" else (1.0, joint.unit_of_position)
        read = getattr(joint.signals, reading) is not None and not (reading == "position" and joint.summed)
        moving = [scale * found[reading] for found in records if reading in found and np.ptp(found[reading]) > 0.0]
        if read and moving:
            steps = [step for x in moving if (step := count_of(x)) is not None]
            out.append(noise_in(joint.name, reading, unit, moving, max(steps, default=0.0)))
    return out
