"""Floors of an arm in motion: between repeats, else what cannot be foreseen; never below what counts of readings make.

A count of an encoder, differentiated twice, is an acceleration that did not happen, and the arm's inertia makes a force
of it: on every joint, and with the posture. A median over the record sees the quiet postures alone, so it is reckoned.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array, Floors, Residuals
from sher3_diagnosis.localise.floors import repeat_floors

from sher3_chain.axes.floors import NOISE_SAMPLES, NOTHING, UNIFORM, foresight, innovation
from sher3_chain.manipulator.description import PER_RUN
from sher3_chain.manipulator.view import MotionView
from sher3_chain.readings.noise import noise_of

POSTURES = 100
"""Postures of a record at which the inertia is reckoned: an rms over them is known to a few per cent."""


def floors_of(views: Sequence[MotionView], found: Sequence[Residuals], repeats: bool) -> list[Floors]:
    """Return the floor per record and channel.

    Args:
        views: records of the arm.
        found: residuals of each record.
        repeats: whether the records are repeats of one motion.
    """
    pooled = repeat_floors([view.excitation for view in views], found) if repeats else {}
    out = []
    for view, residuals in zip(views, found, strict=True):
        floors: Floors = {}
        told, coarse = foresight(view.run), coarseness(view)
        for channel, x in residuals.items():
            row = view.row(channel.actuator)
            joint = view.joints[row]
            step = 0.0 if joint.gain == PER_RUN else joint.effort_resolution  # stated in a unit that is gone
            least = float(np.hypot(step / UNIFORM, coarse[row]))
            if channel.stage == "transmission":
                least = np.sqrt(2.0) * joint.encoder_resolution / UNIFORM
            floors[channel] = np.maximum(pooled.get(channel, innovation(x) / told), max(least, NOTHING))
        out.append(floors)
    return out


def coarseness(view: MotionView) -> Array:
    """Return the force that the noise of all encoders makes of each joint's balance, rms over the motion, (k,)."""
    run = view.links
    noise = [
        max(noise_of(run.motor[:, j], run.period), joint.encoder_resolution / UNIFORM)
        for j, joint in enumerate(view.joints)
    ]
    white = np.random.default_rng(0).normal(size=(max(run.ticks, NOISE_SAMPLES), 1))
    bend = float(run.filtered(np.diff(white, 2, axis=0)).std()) / run.period**2
    rows = np.linspace(0, len(view.position) - 1, min(POSTURES, len(view.position))).astype(int)
    squares = [(view.inertia_matrix(row) * np.array(noise)) ** 2 for row in rows]
    return np.asarray(bend * view.shares * np.sqrt(np.mean(squares, axis=0).sum(axis=1)))
