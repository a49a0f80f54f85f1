"""A force sensor as a machine of the diagnosis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.attribute.search import Left, Say, attribute
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.finding import Finding
from sher3_diagnosis.machine import Machine, Policy
from sher3_effects import pages

from sher3_static.sensor.description import SensorDescription
from sher3_static.sensor.evidence import SensorEvidence, gather_sensor
from sher3_static.sensor.frames import frames, turned
from sher3_static.sensor.record import SensorRun

if TYPE_CHECKING:
    from sher3_static.sensor.reporter import SensorReporter

FRAME, LOAD = "sensor_frame", "tool_gravity"
"""Causes that the notes put into words."""
MOST = 5
"""Causes named at most: bias, load, frame, matrix and drift."""


@dataclass(frozen=True)
class ForceSensor(Machine[SensorRun, SensorEvidence]):
    """A force sensor under a load in several orientations.

    Attributes:
        description: what was recorded, and what hangs on the sensor.
    """

    description: SensorDescription
    policy = Policy(down_to_floor=True)

    def library(self) -> Sequence[Effect]:
        """Return the pages for a sensor."""
        return pages("sensor")

    def audit(self, runs: Sequence[SensorRun]) -> list[str]:
        """Return what was done to the data."""
        return [note for run in runs for note in run.notes]

    def gather(self, runs: Sequence[SensorRun]) -> Sequence[SensorEvidence]:
        """Return the sensor as one part."""
        return [gather_sensor(self.description, runs)]

    def attribute(self, evidence: SensorEvidence, candidates: Candidates, left_over: Left, say: Say) -> Attribution:
        """Search for up to five causes: a sensor out of the box may have all of them."""
        return attribute(candidates, left_over, say, MOST)

    def remarks(self, finding: Finding[SensorEvidence]) -> list[str]:
        """Say what hangs on the sensor, which frame it reads in, and what cannot be told."""
        evidence = finding.evidence
        mass, moment, notes = evidence.mass, evidence.moment, []
        for cause in finding.causes:
            values = {name: p.value for name, p in cause.parameters.items()}
            if cause.effect == LOAD:
                mass, moment = mass + values["mass"], moment + np.array([values[f"com_{x}"] for x in "xyz"])
            if cause.effect == FRAME:
                said = str(turned(frames()[round(values["frame"])], [values[f"r{x}"] for x in "xyz"]))
                notes += [f"the frame of the sensor is stated wrongly: {said}"] if said != str(frames()[0]) else []
        if mass > 0.0:
            centre = ", ".join(f"{1e3 * x:.1f}" for x in moment / mass)
            notes.insert(0, f"load on the sensor: {mass:.4g} kg, centre ({centre}) mm in its frame")
        if evidence.identified:
            notes.append("the mass was identified from the readings: a scale of all forces cannot be told from it")
        return notes

    def reporter(self) -> SensorReporter:
        """Return the part of this machine in a report."""
        from sher3_static.sensor.reporter import SensorReporter

        return SensorReporter()
