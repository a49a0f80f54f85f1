"""What the baselines get: the whitened residuals of a diagnosis, its single fits of every effect, and joint traces."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from sher3_bags import Case, Run, read_case
from sher3_description import ACTUATORS, Robot

from .baseline_exact import exact_inputs
from .baselines import Candidate, Inputs, Stage, Traces
from .oracle import contact_of
from .truth.loop import Script, run_loop
from .truth.robot import nominal

if TYPE_CHECKING:
    from ..channels import Channel
    from ..diagnose import Diagnosis
    from ..evidence import Evidence
    from ..fitting import Fit

Array = NDArray[np.floating[Any]]


def baseline_inputs(diagnosis: Diagnosis, case: Path, without: Collection[str] = ()) -> Inputs:
    """Return the baselines' data for a diagnosed case; residuals are in units of their floor, so every floor is 1."""
    from ..attribute import Candidates

    evidence = diagnosis.evidence
    channels = sorted({c for target in evidence.data.target for c in target})
    stages = [Stage((c.stage, c.actuator), 1.0, _runs(evidence, c)) for c in channels]
    search = Candidates(evidence, without)
    candidates = []
    for effect in search.effects():
        for site in effect.sites():
            if not set(effect.channels(site)) & set(channels):
                continue  # the exact stages have candidates of their own
            found = search.best(effect, site)
            if found is not None and found.terms[-1].channels:
                candidates.append(_candidate(evidence, found))
    recorded = read_case(case)
    exact_stages, exact_candidates = exact_inputs(recorded.runs, recorded.robot)
    exact_candidates = [c for c in exact_candidates if c.effect not in without]
    return Inputs(stages + exact_stages, candidates + exact_candidates, _traces(recorded))


def _runs(evidence: Evidence, channel: Channel) -> list[Array]:
    return [target[channel][:, None] for target in evidence.data.target if channel in target]


def _candidate(evidence: Evidence, found: Fit) -> Candidate:
    """Return a fit as seen at the channel where it takes most off."""
    term = found.terms[-1]
    best: tuple[float, Channel, list[Array]] | None = None
    for channel in sorted(term.channels):
        fitted: list[Array] = []
        gain = 0.0
        for r, target in enumerate(evidence.data.target):
            if channel not in target:
                continue
            rest = target[channel]
            if channel in term.fixed[r]:
                rest = rest - term.fixed[r][channel]
            if channel in term.columns[r]:
                x = term.columns[r][channel]
                rest = rest - x @ found.of(0)[: x.shape[1]]
            gain += float(target[channel] @ target[channel] - rest @ rest)
            fitted.append(rest[:, None])
        if fitted and (best is None or gain > best[0]):
            best = (gain, channel, fitted)
    assert best is not None, "a term touches at least one recorded channel"
    place = (best[1].stage, best[1].actuator)
    return Candidate(term.effect.id, term.effect.family, place, term.width + len(term.shape), best[2])


def _traces(recorded: Case) -> Traces | None:
    runs = [run for run in recorded.runs if "setpoint_js" in run and "measured_js" in run]
    if not runs:
        return None
    simulated = [_simulated(run, recorded.robot) for run in runs]
    return Traces(ACTUATORS, [run["measured_js"].position for run in runs], simulated)


def _simulated(run: Run, robot: Robot) -> Array:
    """Return (n, 5) load positions of the nominal robot driven from the recorded set-points, known loads included."""
    setpoint = run["setpoint_js"]
    force, _, _ = contact_of(run, setpoint.seconds())
    n = len(setpoint)
    script = Script(
        setpoint.position,
        setpoint.velocity,
        force,
        np.zeros((n, 5)),
        np.zeros((n, 5)),
        np.ones(5),
        robot.control_period,
    )
    return run_loop(nominal(robot), script).load
