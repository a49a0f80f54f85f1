"""How the links of an arm move: as their own encoders say, put in time with those of the motors.

A second encoder that comes late, in a slightly other scale or noisy must not move the links: what weight and coupling
need would be off by as much, and pass for friction or a spring. Whether it is late the two encoders say between
themselves; which of them tells the link's motion is asked of the force balance.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from sher3_diagnosis.channel import Array, Mask
from sher3_diagnosis.localise.floors import GAUSSIAN
from sher3_diagnosis.localise.readings import noise_of
from sher3_effects.delay import LONGEST_DELAY, shifted
from sher3_effects.operators import dahl

from sher3_chain.chain.view import BUILDS_UP, LEAD_OF_STROKE
from sher3_chain.manipulator.description import Joint
from sher3_chain.manipulator.model import ArmModel
from sher3_chain.manipulator.signals import JointSignals
from sher3_chain.readings.signals import AxisSignals
from sher3_chain.thresholds import ALIGNED, DELAYED

NOISIER = 2.0
"""Noise of a second encoder over that of the first up to which the links move as it says."""
COUNTS = 3.0
"""Counts by which two encoders must differ, rms, before it matters which of them is believed."""
SHARE_OF_SAMPLES = 4
"""One sample of the residual grid in so many is looked at to choose between two encoders."""
FLIGHT = 5.0
"""Speed of two encoders against each other, over its usual deviation, from which a gap is crossed: a sine of springs or
delays stays below two."""
AT_REST = 0.2
"""Speed of a link over that of the two encoders against each other below which friction holds it."""


def links_of(run: JointSignals, joints: Sequence[Joint], model: ArmModel, coupling: Array) -> JointSignals:
    """Return the signals of a run with the positions of the links in place of the motors'.

    Args:
        run: signals of the k joints, on the side of the motors.
        joints: as described.
        model: of the arm.
        coupling: motor travel = coupling * joint travel, (k, k).
    """
    if run.load is None:
        return run
    found = run
    for j, joint in enumerate(joints):
        load = run.load[:, j]
        if not np.isfinite(load).all() or not _quiet(run, j, joint):
            continue
        timely = shifted(load, run.stage_clock, -lateness_of_load(run, j))
        other = replace(found, motor=_with(found.motor, j, timely))
        apart = float(np.std(load - run.motor[:, j]))
        if apart < COUNTS * joint.encoder_resolution or not _better(found, other, j, model, coupling):
            found = other
    return found


def lateness_of_load(run: AxisSignals, row: int) -> float:
    """Return how late a second encoder is, s, where a delay is most of what play, spring and scale leave; else 0."""
    assert run.load is not None
    behind, position = run.load[:, row] - run.motor[:, row], run.smooth[:, row]
    stroke = max(float(np.ptp(position)), np.finfo(float).tiny)
    side = dahl(position, BUILDS_UP * LEAD_OF_STROKE * stroke)
    force = run.effort[:, row] if run.effort is not None else np.zeros_like(behind)
    plain = np.column_stack([side, force, position, np.ones_like(behind)])
    columns = run.to_grid(np.column_stack([run.velocity[:, row], plain, behind]))[run.inner]
    x, y = columns[:, :-1], columns[:, -1]
    length = np.maximum(np.linalg.norm(x, axis=0), np.finfo(float).tiny)
    all_of_it, without = (np.linalg.lstsq(c, y, rcond=None) for c in (x / length, x[:, 1:] / length[1:]))
    left, before = (
        float(np.sum((y - c @ s[0]) ** 2)) for c, s in ((x / length, all_of_it), (x[:, 1:] / length[1:], without))
    )
    delay = -float(all_of_it[0][0] / length[0])
    return delay if left < DELAYED * before and abs(delay) < LONGEST_DELAY else 0.0


def crossing(run: AxisSignals, row: int) -> Mask:
    """Return (g,) True where a link flies across a gap: the two encoders part much faster than they usually do.

    The impact at the end of the flight lasts less than a sample and is in no force balance. Springs and delays part
    the encoders smoothly, and a link that friction holds is at rest while the motor crosses the gap.
    """
    if run.load is None or not np.isfinite(run.load[:, row]).all():
        return np.zeros(len(run.grid), dtype=bool)
    parting = np.gradient(run.filtered(run.load[:, [row]] - run.motor[:, [row]])[:, 0], run.period)
    pace, link = np.abs(parting), np.abs(run.velocity[:, row] + parting)
    fast = pace > FLIGHT * max(GAUSSIAN * float(np.median(pace)), np.finfo(float).tiny)
    return np.asarray((fast & (link > AT_REST * pace))[run.grid])


def _quiet(run: JointSignals, row: int, joint: Joint) -> bool:
    """Whether the second encoder of a joint is as quiet as the first."""
    assert run.load is not None
    own, other = (noise_of(x[:, row]) for x in (run.motor, run.load))
    return bool(other <= NOISIER * max(own, joint.encoder_resolution))


def _with(positions: Array, row: int, column: Array) -> Array:
    out = positions.copy()
    out[:, row] = column
    return out


def _better(motor: AxisSignals, load: AxisSignals, row: int, model: ArmModel, coupling: Array) -> bool:
    """Whether the force balance of a joint is markedly better with the position of its motor than with its link's."""
    by_motor, by_load = (_balance_residual(x, row, model, coupling) for x in (motor, load))
    return by_motor < (1.0 - ALIGNED) * by_load


def _balance_residual(run: AxisSignals, row: int, model: ArmModel, coupling: Array) -> float:
    """Sum of squares that needed force, friction and a constant leave of a joint's effort."""
    if run.effort is None:
        return 0.0
    back = np.linalg.inv(coupling)
    taken = np.flatnonzero(run.inner)[::SHARE_OF_SAMPLES]
    q, v, a = (x[taken] @ back.T for x in (run.smooth[run.grid], run.velocity[run.grid], run.to_grid(run.acceleration)))
    need = model.needed(q, v, a) @ back
    speed = run.velocity[run.grid][taken, row]
    x = np.column_stack([need[:, row], np.sign(speed), speed, np.ones_like(speed)])
    x = x / np.maximum(np.linalg.norm(x, axis=0), np.finfo(float).tiny)
    y = run.to_grid(run.effort)[taken, row]
    return float(np.sum((y - x @ np.linalg.lstsq(x, y, rcond=None)[0]) ** 2))
