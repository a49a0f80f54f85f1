"""Controls that hold from one row of a log to the next, while the loop that takes them runs many times.

A simulator, and a drive below a policy, take a control at a row and keep it until the next one. Its mean around a row
is then that of two rows, late by half a period, and servo and speed go on within it. Where every row of a faster loop
was logged, or one in ten of a control that goes on between them, it acts at its stamp. A log does not say which: the
one under which the model explains most of the forces is taken, for the whole arm. In a log of every step all are one.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_machines.intake.mending.repeats import filled, fresh_readings, goes_smoothly

from sher3_chain.manipulator.description import Joint, ManipulatorDescription
from sher3_chain.manipulator.mjcf.drives import steps_in
from sher3_chain.manipulator.signals import JointSignals
from sher3_chain.manipulator.view import MotionView


class Single(NamedTuple):
    """A joint by itself, and what its drive moves in the middle posture.

    Attributes:
        joint: as described.
        mass: kg or kg m^2, with what a step adds.
        damping: of the joint, N/(m/s) or N m/(rad/s).
    """

    joint: Joint
    mass: float
    damping: float


Acts = Callable[[Array, float], Array]
"""What a control (n,) does at each row of a log, of a loop of so many steps in one."""


def ways_to_act(
    views: Sequence[MotionView], described: ManipulatorDescription, judged: Collection[str]
) -> Mapping[str, list[JointSignals]]:
    """Return what is said -> the signals of all runs with controls that act so; none where all act alike.

    Args:
        views: of all runs, as read.
        described: the arm.
        judged: joints whose force balance is looked at.
    """
    rows = [i for i, j in enumerate(described.joints) if j.command_law.loop is not None and j.name in judged]
    if described.coupling is not None or not rows:
        return {}
    masses, damping, joints = views[0].inertia, _damping(views[0]), described.joints
    drives = {i: Single(joints[i], float(masses[i]) + joints[i].step_inertia, float(damping[i])) for i in rows}
    ways = {"hold from row to row, while the drives go on": held, "go on evenly from change to change": between}
    acting = {name: [_acting(view.run, drives, way) for view in views] for name, way in ways.items()}
    return {
        f"controls {name}: the model explains more of the forces so": runs
        for name, runs in acting.items()
        if any(run is not view.run for run, view in zip(runs, views, strict=True))
    }


def power_left(views: Sequence[MotionView], judged: Collection[str]) -> float:
    """Return the log of the power that the model leaves of the forces of joints, times their samples, added up."""
    total = 0.0
    for row in (i for i, j in enumerate(views[0].joints) if j.name in judged):
        left = np.concatenate([(v.effort - v.inertial)[v.in_motion(row), row] for v in views])
        total += len(left) * float(np.log(max(left @ left, np.finfo(float).tiny)))
    return total


def _damping(view: MotionView) -> Array:
    """Return the damping of each joint about the middle posture, (k,)."""
    losses, stated = view.model.losses, np.array([joint.viscous for joint in view.joints])
    if losses is None:
        return stated
    middle = np.tile(np.median(view.position, axis=0), (len(stated), 1))
    return np.asarray(stated + np.diag(losses.in_motion(middle, np.eye(len(stated)))))


def _acting(run: JointSignals, drives: Mapping[int, Single], way: Acts) -> JointSignals:
    """Return a run with forces and references as they act; the same run where nothing changes."""
    assert run.effort is not None
    steps = max(steps_in(run.period, drive.joint.command_law.loop) for drive in drives.values())
    slow = replace(run, steps=steps if way is held else 1.0)
    asked = {row: _commanded(slow, row, drive) for row, drive in drives.items()}
    acts = {row: slow.at_rows(way(x, slow.steps)) for row, x in asked.items()}
    if all(np.array_equal(acts[row], asked[row]) for row in drives):
        return run
    effort, reference = run.effort.copy(), None if run.reference is None else run.reference.copy()
    within = np.zeros(effort.shape[1])
    for row, drive in drives.items():
        effort[:, row], within[row] = _given(slow, row, drive, acts[row])
        if reference is not None and drive.joint.signals.reference is not None:
            reference[:, row] = acts[row]
    return replace(slow, effort=effort, reference=reference, within=within)


def _commanded(run: JointSignals, row: int, drive: Single) -> Array:
    """Return what a drive was asked for, (n,): a force, or a place; that of the recorded force where none was logged.

    The force is that at the begin of a row, by the speed which the step before left.
    """
    assert run.effort is not None
    law, force = drive.joint.command_law, run.effort[:, row]
    if law.position_gain is None:
        return force
    if run.reference is not None and drive.joint.signals.reference is not None:
        return run.reference[:, row]
    own = within_a_row(drive, run)
    begin = own.begins * run.speed_of(run.motor)[:, row] + own.behind * run.acceleration[:, row]
    return np.asarray(run.motor[:, row] + (force + law.velocity_gain * begin) / law.position_gain)


def _given(run: JointSignals, row: int, drive: Single, acts: Array) -> tuple[Array, float]:
    """Return the force (n,) that a drive gives around each row, and how much of it is put right, rms.

    Args:
        run: with the steps in a row.
        row: of the joint.
        drive: of the joint.
        acts: force or place that it was asked for, (n,), at each row.
    """
    law, q = drive.joint.command_law, run.motor[:, row]
    if law.position_gain is None:
        return acts, 0.0
    own, v, a = within_a_row(drive, run), run.speed_of(run.motor)[:, row], run.acceleration[:, row]
    limit = np.inf if law.limit is None else law.limit
    force = np.clip(law.position_gain * (acts - q) - law.velocity_gain * v, -limit, limit)
    right = own.inertia * a + own.damping * v
    within = [right]
    if drive.joint.signals.effort is not None:  # what a step adds is that of a recorded force there
        force = force + 0.5 * (law.loop or 0.0) * law.velocity_gain * a
        within.append(law.velocity_gain * ((own.begins - 1.0) * v + own.behind * a))
    return force - right, float(np.hypot.reduce([np.std(run.to_grid(x)) for x in within]))


def held(control: Array, steps: float) -> Array:
    """Return the mean (n,) around each row of a control that holds for so many steps of a loop from each one.

    The second difference of places weighs the steps of the rows before and behind by a triangle.
    """
    before = np.concatenate([control[:1], control[:-1]])
    return np.asarray(0.5 * ((1.0 + 1.0 / steps) * control + (1.0 - 1.0 / steps) * before))


def between(control: Array, steps: float) -> Array:
    """Return a control (n,) that goes on evenly between the rows in which it changes; as it is where it jumps."""
    fresh = fresh_readings(control)
    return filled(control, fresh) if not fresh.all() and goes_smoothly(control[fresh]) else control


class Within(NamedTuple):
    """What a servo does within a row of places that lie on a line, or on a parabola.

    Attributes:
        inertia, damping: force that its law at the rows has too much, per acceleration and per speed.
        begins, behind: speed at the begin of a row, per speed [1] and per acceleration [s].
    """

    inertia: float = 0.0
    damping: float = 0.0
    begins: float = 1.0
    behind: float = 0.0


def within_a_row(drive: Single, run: JointSignals) -> Within:
    """Return what a servo does within a row, while its control holds.

    The joint by itself is a linear system, stepped as implicit methods do. Each row has a control of its own, chosen so
    that the places of all rows lie on a line of 1 rad/s, or on a parabola of 1 rad/s^2; the speeds at the rows, and the
    controls, follow.

    Args:
        drive: the joint.
        run: its period, s, and the steps of the loop in one of its rows.
    """
    law, period, n = drive.joint.command_law, run.period, round(run.steps)
    if n == 1 or not law.position_gain:
        return Within()
    h, gain, loss = period / n, law.position_gain, law.velocity_gain + drive.damping
    mass = drive.mass + 0.5 * h * loss
    slower = np.array([-h * gain / mass, 1.0 - h * loss / mass])
    step = np.array([np.array([1.0, 0.0]) + h * slower, slower])
    taken = np.array([h * h * gain / mass, h * gain / mass])
    row, control = np.eye(2), np.zeros(2)
    for _ in range(n):
        row, control = step @ row, step @ control + taken
    keeps = 1.0 - row[1, 1]
    asks = row[0, 1] * control[1] / keeps + control[0]
    lead = period / asks  # of a control before the line, rad
    begins = control[1] * lead / keeps
    above = (0.5 * period**2 + row[0, 1] * begins * period / keeps) / asks  # of a control over the parabola, rad
    late = 0.5 * (1.0 - 1.0 / n)
    acts = above + late * (0.5 * period - lead) * period - (1.0 - n**-2) / 12.0 * period**2
    behind = (control[1] * above - begins * period) / keeps
    return Within(gain * acts - drive.mass, gain * (lead - late * period) - loss, begins, behind)
