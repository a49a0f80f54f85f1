"""The standard set as the nominal robot foresees it: what its runs would be like, before any is recorded."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from functools import cache, partial

import numpy as np
from sher3_description import Robot
from sher3_description.contract import REFERENCE_TEMPERATURE
from sher3_diagnosis.channel import AT_TIP, Floors
from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.fit.term import Term
from sher3_diagnosis.fit.tolerance import as_built
from sher3_diagnosis.machine import Rehearsal

from sher3_gap.case.loading import signals_of
from sher3_gap.evidence import SherEvidence, tolerated
from sher3_gap.excitation import catalogue, excite
from sher3_gap.experiments.rehearsal import rehearse
from sher3_gap.experiments.separation import floors_of
from sher3_gap.signals import RunSignals
from sher3_gap.stages.floors import resolution_floors
from sher3_gap.stages.geometry import Geometry
from sher3_gap.stages.residuals import all_residuals
from sher3_gap.stages.view import SherView

APART = ("p1", "p2")
"""Postures of an experiment: the two opposite ones."""
REPEATS = 2
WHY = f"what the rivals foretell differs most here; twice in each of the postures {' and '.join(APART)}"
WARMER = 5.0
"""Degrees by which a robot is warmed for an experiment, K: an hour of work in a warm room."""
LOADED, TRACKED, WARMED = "known weights on the tip", "a tracker at the tip", f"the robot {WARMER:g} K warmer"
SAME = "the recorded excitations"
SAME_WHY = "nothing but the warmth differs, so that nothing else can be taken for it; under names of their own"


def foreseen(evidence: SherEvidence, felt: Collection[str]) -> Iterator[Rehearsal]:
    """Yield each excitation of the standard set, twice in each of two postures, with the floors of a case.

    First as the case was recorded; then with known weights or with the tip tracked, where it had none; then, where
    warmth is `felt` by a cause, with the robot warmed (which moves no nominal robot), before that the recorded
    excitations once more.
    """
    floor, robot = floors_of(evidence), evidence.robot
    loads = any(run.payload for run in evidence.runs)
    names = [n for n in catalogue() if n != "task" and (loads or n != "loads")]
    usual = temperature_of(evidence)
    at_tip = {c: x for c, x in resolution_floors(robot, robot.control_period).items() if c.stage in AT_TIP}
    ways = {"": (names, usual, floor)}
    ways |= {} if loads else {LOADED: (["loads"], usual, floor)}
    ways |= {} if at_tip.keys() & floor.keys() else {TRACKED: (names, usual, at_tip | floor)}
    ways |= {WARMED: (names, usual + WARMER, floor)} if "temperature" in felt else {}
    made = cache(partial(_nominal, robot))
    for added, (tried, temperature, known) in ways.items():
        if added == WARMED:
            yield Rehearsal(SAME, SAME_WHY, WARMED, _warmed(evidence, floor, temperature), elsewhere=False)
        for name in tried:
            data = _expected_data([_at(temperature, run) for run in made(name)], robot, known)
            yield Rehearsal(name, WHY, added, data, as_built=partial(_as_built, evidence, data))


def temperature_of(evidence: SherEvidence) -> float:
    """Return the mean temperature of a case, deg C; the reference where it was not recorded."""
    known = [run.temperature.mean() for run in evidence.runs if run.temperature is not None]
    return float(np.mean(known)) if known else REFERENCE_TEMPERATURE


def _as_built(evidence: SherEvidence, more: Standardised) -> Sequence[Term]:
    """Return the deviations within tolerance that a case and further runs show together: new places show more."""
    there = tolerated(more, evidence.robot)
    members = [t.with_runs(m) for t, m in zip(evidence.tolerances, there, strict=True)]
    return as_built(evidence.data.with_runs(more, more.target), members)


def _warmed(evidence: SherEvidence, floor: Floors, temperature: float) -> Standardised:
    """Return the first run of each recorded excitation at another temperature."""
    first = [evidence.excitations.index(name) for name in dict.fromkeys(evidence.excitations)]
    geometry = evidence.view(0).geometry
    views = [SherView(_at(temperature, evidence.runs[r]), evidence.robot, geometry) for r in first]
    residuals = [{c: x for c, x in evidence.data.residuals[r].items() if c in floor} for r in first]
    return Standardised(views, residuals, [floor] * len(first))


def _at(temperature: float, run: RunSignals) -> RunSignals:
    """Return a run at a temperature, deg C."""
    return replace(run, temperature=np.full(run.ticks, temperature))


def _nominal(robot: Robot, name: str) -> list[RunSignals]:
    """Return the runs of an experiment without any cause."""
    asked = [(excite(name, robot, posture=p), 0) for p in APART]
    return [signals_of(run, robot, f"{name} {i}") for i, run in enumerate(rehearse(robot, asked, scatter=None))]


def _expected_data(runs: Sequence[RunSignals], robot: Robot, floor: Floors) -> Standardised:
    """Return runs that were never made, `REPEATS` times each, at the channels of a floor; only when they count."""
    geometry = Geometry(robot)
    views = [SherView(run, robot, geometry) for run in runs]
    told = [{c: x for c, x in all_residuals(run, robot, geometry).items() if c in floor} for run in runs]
    return Standardised(views * REPEATS, told * REPEATS, [floor] * len(runs) * REPEATS)
