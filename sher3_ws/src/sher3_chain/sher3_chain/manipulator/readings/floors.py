"""Floors of an arm in motion: between repeats, else what cannot be foreseen; never below what counts of readings make.

A count of an encoder, differentiated twice, is an acceleration that did not happen, and the arm's inertia makes a force
of it: on every joint, and with the posture. A median over the record sees the quiet postures alone, so it is reckoned.
"""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array, Channel, Floors
from sher3_diagnosis.localise.floors import UNIFORM
from sher3_diagnosis.localise.readings import noise_of

from sher3_chain.floors.innovation import NOTHING, white_behind
from sher3_chain.manipulator.description import PER_RUN
from sher3_chain.manipulator.view import MotionView

ALONE = 0.1
"""Share of what a servo gives within a row that a joint by itself, in the middle posture, does not say."""
POSTURES = 100
"""Postures of a record at which the inertia is reckoned: an rms over them is known to a few per cent."""


def resolution_floors(view: MotionView) -> Floors:
    """Return what counts of efforts and encoders make of every joint's balance, and of its encoders' difference."""
    floors: Floors = {}
    within = 0.0 if view.run.within is None else ALONE * view.run.within
    for joint, coarse in zip(view.joints, np.hypot(coarseness(view), within), strict=True):
        step = 0.0 if joint.gain == PER_RUN else joint.effort_resolution  # stated in a unit that is gone
        force, count = float(np.hypot(step / UNIFORM, coarse)), np.sqrt(2.0) * joint.encoder_resolution / UNIFORM
        floors[Channel("motor_mechanics", joint.name)] = np.array([max(force, NOTHING)])
        floors[Channel("transmission", joint.name)] = np.array([max(count, NOTHING)])
    return floors


def coarseness(view: MotionView) -> Array:
    """Return the force that the noise of all encoders makes of each joint's balance, rms over the motion, (k,)."""
    run = view.links
    noise = [noise_of(run.motor[:, j], joint.encoder_resolution) for j, joint in enumerate(view.joints)]
    *_, bend = white_behind(run)
    rows = np.linspace(0, len(view.position) - 1, min(POSTURES, len(view.position))).astype(int)
    squares = (view.inertia_matrix(rows) * np.array(noise)) ** 2
    return np.asarray(bend * view.shares * np.sqrt(np.mean(squares, axis=0).sum(axis=1)))
