"""What the baselines get: standardised residuals of a diagnosis, its single fits of every effect, and joint traces."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from sher3_bags import read_case
from sher3_description import ACTUATORS

from sher3_challenge.baselines.exact import exact_inputs
from sher3_challenge.baselines.inputs import Candidate, Inputs, Stage, Traces

if TYPE_CHECKING:
    from sher3_diagnosis.channel import Channel
    from sher3_diagnosis.fit.fitting import Fit
    from sher3_diagnosis.machine import Diagnosis
    from sher3_gap.evidence import SherEvidence

Array = NDArray[np.floating[Any]]


def baseline_inputs(diagnosis: Diagnosis[SherEvidence], case: Path, without: Collection[str] = ()) -> Inputs:
    """Return the baselines' data for a diagnosed case; residuals are in units of their floor, so every floor is 1."""
    from sher3_diagnosis.attribute.candidates import Candidates

    evidence = diagnosis.findings[0].evidence
    channels = sorted({c for target in evidence.data.target for c in target})
    stages = [Stage((c.stage, c.actuator), 1.0, _runs(evidence, c)) for c in channels]
    search = Candidates(evidence, [e for e in diagnosis.machine.effects(evidence) if e.id not in without])
    candidates = []
    for effect in search.effects:
        for site in search.sites(effect):
            if not set(effect.channels(site)) & set(channels):
                continue  # the exact stages have candidates of their own
            found = search.best(effect, site)
            if found is not None and found.terms[-1].channels:
                candidates.append(_candidate(evidence, found))
    recorded = read_case(case)
    exact_stages, exact_candidates = exact_inputs(recorded.runs, recorded.robot)
    exact_candidates = [c for c in exact_candidates if c.effect not in without]
    return Inputs(stages + exact_stages, candidates + exact_candidates, _traces(evidence))


def _runs(evidence: SherEvidence, channel: Channel) -> list[Array]:
    return [target[channel][:, None] for target in evidence.data.target if channel in target]


def _candidate(evidence: SherEvidence, found: Fit) -> Candidate:
    """Return a fit as seen at the channel where it takes most off."""
    term = found.terms[-1]
    seen = {c: _residuals(evidence, found, c) for c in sorted(term.channels)}
    gains = {c: gain for c, (fitted, gain) in seen.items() if fitted}
    best = max(gains, key=gains.__getitem__)
    size = term.width + len(term.shape)
    return Candidate(term.effect.id, term.effect.family, (best.stage, best.actuator), size, seen[best][0])


def _residuals(evidence: SherEvidence, found: Fit, channel: Channel) -> tuple[list[Array], float]:
    """Return what a fit of one term leaves of a channel, per run, and the energy it takes off in all."""
    term, gain = found.terms[-1], 0.0
    fitted: list[Array] = []
    for run, target in enumerate(evidence.data.target):
        if channel not in target:
            continue
        rest: Array = target[channel] - term.adds(run, channel, found.of(0))
        gain += float(target[channel] @ target[channel] - rest @ rest)
        fitted.append(rest[:, None])
    return fitted, gain


def _traces(evidence: SherEvidence) -> Traces | None:
    """Return joint positions beside those of the nominal robot driven from the recorded set-points and loads."""
    from sher3_gap.nominal_replay import driven_as

    measured, simulated = [], []
    for run in evidence.runs:
        twin = driven_as(run, evidence.robot)
        if twin is not None and run.load is not None and twin.load is not None:
            measured.append(run.load)
            simulated.append(twin.load[: len(run.load)])
    return Traces(ACTUATORS, measured, simulated) if measured else None
