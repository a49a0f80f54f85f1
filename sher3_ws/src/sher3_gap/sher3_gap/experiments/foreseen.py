"""The standard set as the nominal robot foresees it: what its runs would be like, before any is recorded."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from sher3_description.contract import REFERENCE_TEMPERATURE
from sher3_diagnosis.channel import AT_TIP, Floors
from sher3_diagnosis.fit.term import Term
from sher3_diagnosis.fit.tolerance import as_built
from sher3_diagnosis.fit.whitened import Whitened
from sher3_diagnosis.machine import Rehearsal

from sher3_gap.case.loading import signals_of
from sher3_gap.evidence import SherEvidence, gather, tolerated
from sher3_gap.excitation import catalogue, excite
from sher3_gap.experiments.rehearsal import rehearse
from sher3_gap.experiments.separation import floors_of
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


def foreseen(evidence: SherEvidence) -> Iterator[Rehearsal]:
    """Yield each excitation of the standard set, twice in each of two postures, with the floors of a case.

    First as the case was recorded; then with known weights or with the tip tracked, where it had none; then with the
    robot warmed, before that the recorded excitations once more.
    """
    floor = floors_of(evidence)
    loads = any(run.payload for run in evidence.runs)
    names = [n for n in catalogue() if n != "task" and (loads or n != "loads")]
    usual = temperature_of(evidence)
    ways = {"": (names, usual)}
    ways |= {} if loads else {LOADED: (["loads"], usual)}
    ways |= {} if any(c.stage in AT_TIP for c in floor) else {TRACKED: (names, usual)}
    ways |= {WARMED: (names, usual + WARMER)}
    for added, (tried, temperature) in ways.items():
        if added == WARMED:
            yield Rehearsal(SAME, SAME_WHY, WARMED, _warmed(evidence, floor, temperature), elsewhere=False)
        for name in tried:
            data = _runs(name, evidence, floor, temperature, added == TRACKED)
            yield Rehearsal(name, WHY, added, data, as_built=partial(_as_built, evidence, data))


def temperature_of(evidence: SherEvidence) -> float:
    """Return the mean temperature of a case, deg C; the reference where it was not recorded."""
    known = [run.temperature.mean() for run in evidence.runs if run.temperature is not None]
    return float(np.mean(known)) if known else REFERENCE_TEMPERATURE


def _as_built(evidence: SherEvidence, more: Whitened) -> Sequence[Term]:
    """Return the deviations within tolerance that a case and further runs show together: new places show more."""
    both = evidence.data.with_runs(more, more.target)
    return as_built(both, list(tolerated(both, evidence.robot)))


def _warmed(evidence: SherEvidence, floor: Floors, temperature: float) -> Whitened:
    """Return the first run of each recorded excitation at another temperature."""
    first = [evidence.excitations.index(name) for name in dict.fromkeys(evidence.excitations)]
    geometry = evidence.view(0).geometry
    runs = [replace(evidence.runs[r], temperature=np.full(evidence.runs[r].ticks, temperature)) for r in first]
    views = [SherView(run, evidence.robot, geometry) for run in runs]
    told = [{c: x for c, x in evidence.data.residuals[r].items() if c in floor} for r in first]
    return Whitened(views, told, [floor] * len(runs))


def _runs(name: str, evidence: SherEvidence, floor: Floors, temperature: float, tracked: bool) -> Whitened:
    """Return the runs of an experiment without any cause; those of a new sensor have the floor of the nominal robot."""
    asked = [(excite(name, evidence.robot, posture=p), 0) for p in APART]
    made = rehearse(evidence.robot, asked, scatter=None, temperature=temperature)
    runs = [signals_of(run, evidence.robot, f"{name} {i}") for i, run in enumerate(made)]
    seen = gather(runs, evidence.robot)
    known = floors_of(seen) | floor if tracked else floor
    told = [{c: x for c, x in residuals.items() if c in known} for residuals in seen.data.residuals]
    return Whitened(seen.views * REPEATS, told * REPEATS, [known] * len(runs) * REPEATS)
