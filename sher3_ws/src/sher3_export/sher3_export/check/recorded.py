"""What was recorded of each joint, as MuJoCo needs it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from sher3_chain.axes.machine import Axes
from sher3_chain.joint.conditions import carried_in
from sher3_chain.joint.description import Axis
from sher3_chain.joint.record import AxesRun
from sher3_chain.manipulator.description import Joint, ManipulatorDescription
from sher3_chain.manipulator.machine import Manipulator
from sher3_chain.manipulator.mjcf.drives import steps_in
from sher3_common.numbers.smoothing import savitzky_golay
from sher3_diagnosis.channel import Array

from sher3_export.errors import ExportError

SMOOTH = 0.01
"""Half the time, s, over which a start speed is taken: long against a count, short against a motion."""
LEAST = 4
"""Samples of that half at least: a parabola through fewer follows the counts. In a slower log it is one."""


@dataclass(frozen=True)
class Track:
    """One joint in one run, n samples.

    Attributes:
        position, velocity: (n,) of the motor's side, smoothed: where a simulation may start.
        measured: (n,) m or rad, of the load where it has an encoder: what a simulation is held against.
        behind: (n,) load less motor, m or rad; None with one encoder.
        drive: (n,) force, N or N m, or reference of a servo, m or rad; None where nothing drives the joint.
        unit: of its place, m or rad.
        servo: whether the drive is the reference of a servo.
    """

    position: Array
    velocity: Array
    measured: Array
    behind: Array | None
    drive: Array | None
    unit: str
    servo: bool = False


class Load(NamedTuple):
    """A known mass that was put on in one run.

    Attributes:
        mass: kg, or kg m^2 on an axis that turns.
        on: joint of the model that it moves with, or link where it has a centre.
        centre: of it in the frame of the link's joint, m; None on an axis, of which its weight was recorded apart.
    """

    mass: float
    on: str
    centre: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class Recorded:
    """One run: its period, s, a track for each joint, by the joint's name in the model, and what was put on."""

    period: float
    tracks: Mapping[str, Track]
    carried: Sequence[Load] = ()


def recorded(machine: object, runs: Sequence[Any], joints: Mapping[str, str], late: bool) -> list[Recorded]:
    """Return what was recorded of a chain of axes, or of an arm in motion; on its joints where a coupling is stated.

    Args:
        machine: of the case.
        runs: of the case.
        joints: axis -> joint of the model, where their names differ.
        late: whether a cause acts between command and force, so that the command drives and not the measured effort.

    Raises:
        ExportError: the case is of another kind.
    """
    if not isinstance(machine, Axes | Manipulator):
        remedy = (
            "check a chain of axes or an arm in motion; the SHER's verdicts are checked by `sher3 gap apply --case`"
        )
        raise ExportError("records of this kind of machine are not run in MuJoCo", remedy=remedy)
    axes = [axis for axis in machine.described.chain if isinstance(machine, Manipulator) or not is_passive(axis)]
    coupled = isinstance(machine, Manipulator) and machine.described.coupling is not None
    late = late and not coupled  # what a motor that moves several joints is late by no model can be given
    out, names = [], [run.name for run in runs]
    for number, run in enumerate(runs):
        places = [run.signals[axis.name]["position"] for axis in axes]
        drives = [drive_of(run.signals[axis.name], axis, late) for axis in axes]
        if isinstance(machine, Manipulator) and coupled:
            places, drives = on_joints(places, drives, machine.described)
        each = zip(axes, places, drives, strict=True)
        tracks = {joints.get(axis.name, axis.name): track_of(run, axis, q, drive, late) for axis, q, drive in each}
        out.append(Recorded(run.period, tracks, carried_by(machine, names, joints)[number]))
    return out


def carried_by(machine: Axes | Manipulator, runs: Sequence[str], joints: Mapping[str, str]) -> list[list[Load]]:
    """Return the known masses that were put on in each run; raises MachineError where a stated run is none of them."""
    if isinstance(machine, Manipulator):
        known = carried_in(machine.described.carried, runs)
        return [[] if x is None else [Load(x.mass, x.link, x.centre)] for x in known]
    each = {joints.get(axis.name, axis.name): carried_in(axis.carried, runs) for axis in machine.described.axes}
    return [[Load(m, joint) for joint, x in each.items() if (m := x[r]) is not None] for r in range(len(runs))]


def is_passive(axis: Axis) -> bool:
    """Return whether an axis of a chain is in no model: nothing drives it, and nobody knows what it weighs."""
    return axis.free and axis.mass is None


def on_joints(
    places: Sequence[Array], drives: Sequence[Array | None], described: ManipulatorDescription
) -> tuple[list[Array], list[Array | None]]:
    """Return places and forces (n,) of the motors as those of the joints that they move, where they were recorded so.

    A joint of which no force is known has none.
    """
    travel = np.asarray(described.coupling, dtype=float)
    q = np.column_stack(places)
    force = np.column_stack([np.full(len(q), np.nan) if x is None else x for x in drives])
    q = q @ np.linalg.inv(travel).T if described.position_of == "motors" else q
    force = force @ travel if described.effort_of == "motors" else force
    return list(q.T), [None if np.isnan(x).any() else x for x in force.T]


def track_of(run: AxesRun, axis: Axis, q: Array, drive: Array | None, late: bool) -> Track:
    """Return the track of one axis, of its places and forces (n,)."""
    signals = run.signals[axis.name]
    half = max(LEAST, round(SMOOTH / run.period)) if run.period < SMOOTH else 1
    smooth = [savitzky_golay(q, 2 * half + 1, 2, k, run.period) for k in (0, 1)]
    load = signals.get("load")
    behind = None if load is None else load - q
    servo = axis.servo or (isinstance(axis, Joint) and axis.follows and (late or holds(axis, run.period)))
    drive = signals["reference"] if servo else drive
    return Track(smooth[0], smooth[1], q if load is None else load, behind, drive, axis.unit_of_position, servo)


def holds(joint: Joint, period: float) -> bool:
    """Return whether the servo of a joint goes on within a row of the log, s: no force of its rows says how."""
    return joint.by_its_law and steps_in(period, joint.command_law.loop) > 1.0


def drive_of(signals: Mapping[str, Array], axis: Axis, late: bool) -> Array | None:
    """Return the force (n,), N or N m, or None where nothing drives the joint."""
    if axis.free and "effort" not in signals:
        return None
    if "command" in signals and (late or "effort" not in signals):
        return axis.command_law.gain * signals["command"]
    return signals["effort"] * (axis.gain if isinstance(axis, Joint) and isinstance(axis.gain, float) else 1.0)
