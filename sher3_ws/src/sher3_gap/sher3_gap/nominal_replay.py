"""The pipeline's own floor: residuals of the nominal plant driven as each run was."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from sher3_bags import RunMetadata
from sher3_description import Robot
from sher3_description.contract import REFERENCE_TEMPERATURE
from sher3_diagnosis.channel import Array
from sher3_sim.closed_loop import simulate

from sher3_gap.case.loading import signals_of
from sher3_gap.signals import RunSignals


def driven_as(run: RunSignals, robot: Robot, seed: int = 0, shift: float = 0.0, **plant: object) -> RunSignals | None:
    """Simulate the plant on a run's set-points, loads and temperature; None for a run without set-points.

    `shift` moves the set-points by that share of a motor encoder count: whether a reading at rest sits still or
    chatters between two counts depends on where between them it is. `plant` goes to `sher3_sim.closed_loop` (effects,
    parameters).
    """
    if run.reference is None:
        return None
    counts = np.array([a.motor_encoder for a in robot.actuators])
    simulated = simulate(
        robot,
        run.reference + shift * counts,
        np.hstack([bridged(run), np.zeros((run.ticks, 3))]),
        seed=seed,
        setpoint_velocity=run.reference_velocity,
        temperature=REFERENCE_TEMPERATURE if run.temperature is None else run.temperature,
        metadata=RunMetadata(excitation=run.excitation, repeat=run.repeat, payload=run.payload),
        **plant,  # type: ignore[arg-type]
    )
    return signals_of(simulated, robot, run.name)


def first_alike(runs: Sequence[RunSignals]) -> list[int]:
    """Return for each run the number of the first that was driven alike: warmth moves no nominal plant."""
    keys: list[object] = []
    for r, run in enumerate(runs):
        driven = (run.reference, run.reference_velocity, bridged(run))
        keys.append(r if run.reference is None else tuple(x.tobytes() for x in driven if x is not None))
    return [keys.index(key) for key in keys]


def followed(run: RunSignals) -> RunSignals:
    """Return a run without set-points with its own motion as set-points: a twin then moves as the run did."""
    if run.reference is not None:
        return run
    path = run.smooth
    return replace(run, reference=path, reference_velocity=np.gradient(path, run.period, axis=0))


def bridged(run: RunSignals) -> Array:
    """Known contact force, (n, 3), with straight lines over the ramps where it is not known."""
    if run.contact is None:
        return np.zeros((run.ticks, 3))
    if run.contact_known is None or run.contact_known.all():
        return run.contact
    known = np.flatnonzero(run.contact_known)
    ticks = np.arange(run.ticks)
    return np.stack([np.interp(ticks, known, c[known]) for c in run.contact.T], axis=1)
