"""Closure at the tip: the tracked tip against the model run from the set-points, nominal and with the causes added.

Causes upstream of the load encoders run in the simulator. What acts between the encoders and the tip is added as the
fit found it, with the coefficients of the other runs: it does not change how the axes move.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from sher3_description import Robot
from sher3_diagnosis.channel import Array
from sher3_diagnosis.fit.fitting import Fit, Term
from sher3_diagnosis.fit.tolerance import NUISANCE
from sher3_diagnosis.quantify.closure import interval_of, up_to_whole
from sher3_diagnosis.thresholds import NO_TIP_GAP
from sher3_diagnosis.verdict import Cause, Interval
from sher3_effects import to_effects

from sher3_gap.evidence import SherEvidence
from sher3_gap.nominal_replay import driven_as, first_alike
from sher3_gap.signals import RunSignals
from sher3_gap.simulate.spline import through
from sher3_gap.stages.units import LOADED_TIP, TIP


def tip_closure(evidence: SherEvidence, causes: Sequence[Cause], fit: Fit) -> Interval | None:
    """Closure of the free-run tip position; None without a tracker, without set-points, or without a gap at the tip.

    What a robot as built is expected to deviate by is no gap: no cause closes it.
    """
    at_tip = {t.key for t in fit.terms if TIP in t.channels or LOADED_TIP in t.channels}
    effects = to_effects([c for c in causes if (c.effect, c.actuator) not in at_tip], evidence.robot)
    quiet = without_tracker_noise(evidence.robot)
    rows, own, first = [], [], first_alike(evidence.runs)
    twin_of = cache(lambda r: driven_as(evidence.runs[r], quiet))
    for r, run in enumerate(evidence.runs):
        if run.tracker_position is None or run.reference is None:
            continue
        floor = evidence.floors[r].get(TIP)
        if floor is None:
            continue
        power = float(np.sum(floor[:3] ** 2))
        twin = twin_of(first[r])
        nominal = tip_error(run, twin)
        corrected = tip_error(run, driven_as(run, quiet, effects=effects)) if effects else nominal
        corrected = corrected - tip_shift(evidence, fit, r, shared_ticks(run, twin))
        known = known_at(run, shared_ticks(run, twin))
        rows.append([np.mean(np.sum(e[known] ** 2, axis=1)) / power for e in (nominal, corrected)] + [1.0])
        own.append(as_built_share(evidence, r))
    if not rows:
        return None
    table = np.array(rows)
    if table[:, 0].mean() < NO_TIP_GAP + float(np.mean(own)):
        return None
    found = interval_of(table)
    return up_to_whole(found) if causes else found


def as_built_share(evidence: SherEvidence, run: int) -> float:
    """Return the mean square of the tip's position that deviations within tolerance make in a run, over its floor."""
    floor = evidence.floors[run][TIP]
    columns = [t.columns[run][TIP] for t in evidence.nuisance if TIP in t.columns[run]]
    power = [np.sum(x**2, axis=1).reshape(-1, len(floor))[:, :3] @ floor[:3] ** 2 for x in columns]
    return float(sum(x.mean() for x in power) / np.sum(floor[:3] ** 2))


def without_tracker_noise(robot: Robot) -> Robot:
    """A robot whose tracker reads the tip as it is: the model's tip, not a second measurement of it."""
    silent = {"noise_position": 0.0, "noise_rotation": 0.0}
    return robot.model_copy(update={"tracker": robot.tracker.model_copy(update=silent)})


def shared_ticks(run: RunSignals, twin: RunSignals | None) -> np.ndarray:
    """Ticks at which the run has a tracker sample and its twin's path is known, (m,): a tracker keeps its own time."""
    assert twin is not None and run.tracker_index is not None and twin.tracker_index is not None
    ticks = run.tracker_index
    return ticks[(ticks >= twin.tracker_index[0]) & (ticks <= twin.tracker_index[-1])]


def known_at(run: RunSignals, ticks: np.ndarray) -> np.ndarray:
    """Whether the load on the tip is known at each of the ticks, (m,); all of them where it never is."""
    if run.contact_known is None or not run.contact_known[ticks].any():
        return np.ones(len(ticks), dtype=bool)
    return run.contact_known[ticks]


def tip_error(run: RunSignals, twin: RunSignals | None) -> Array:
    """Tracked tip of the run minus that of its twin at the shared ticks, (m, 3)."""
    assert twin is not None and run.tracker_index is not None and twin.tracker_index is not None
    assert run.tracker_position is not None and twin.tracker_position is not None
    ticks = shared_ticks(run, twin)
    path = through(twin.tracker_index, twin.tracker_position, ticks)
    return run.tracker_position[np.isin(run.tracker_index, ticks)] - path


def tip_shift(evidence: SherEvidence, fit: Fit, run: int, ticks: np.ndarray) -> Array:
    """Displacement of the tip by the fitted causes behind the load encoders, at the given ticks, (m, 3)."""
    signals = evidence.runs[run]
    shift = np.zeros((len(signals.grid), 3))
    for i, term in enumerate(fit.terms):
        if term.effect.family != NUISANCE:
            shift += _shift(evidence, term, fit.loro_of(i)[run], run)
    return np.stack([np.interp(ticks, signals.grid, column) for column in shift.T], axis=1)


def _shift(evidence: SherEvidence, term: Term, coefficients: Array, run: int) -> Array:
    """What one term adds at the tip on the residual grid, (g, 3): the loaded samples where there are some."""
    view = evidence.view(run)
    out = np.zeros((len(evidence.runs[run].grid), 3))
    if not term.channels & {TIP, LOADED_TIP}:
        return out
    signature = term.effect.signature(view, term.site, term.shape)
    for channel, where in ((TIP, ~view.path.loaded), (LOADED_TIP, view.path.loaded)):
        if channel in signature.columns:
            out[where] += (signature.columns[channel][:, :3] @ coefficients)[where]
        if channel in signature.fixed:
            out[where] += signature.fixed[channel][where, :3]
    return out
