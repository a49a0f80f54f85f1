"""The standard set: what each excitation moves, as pure functions of the robot.

Strokes scale with the actuator: its unit is what it travels in 0.1 s at its velocity limit (1.22 mm; roll 0.12 rad).
Axes start and turn at different times, so that couplings between them do not look like effects of one.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator

import numpy as np
from sher3_description import Robot
from sher3_description.equipment import Actuator

from sher3_gap.excitation.excitation import Load
from sher3_gap.excitation.profile import (
    FloatArray,
    Move,
    SpeedChange,
    move_track,
    shortest_move,
    shortest_speed_change,
    speed_track,
)

Tracks = tuple[FloatArray, FloatArray]
"""Set-points (n, actuators) at times (n,) [s]: positions [m, rad], from zero, and velocities [m/s, rad/s]."""

# Fractions of a limit that the set-points use; the rest is left to the position loop.
_SPEED, _ACCELERATION = 0.75, 0.8


def _columns(tracks: Iterable[Tracks]) -> Tracks:
    positions, velocities = zip(*tracks, strict=True)
    return np.column_stack(positions), np.column_stack(velocities)


def _unit(actuator: Actuator) -> float:
    return 0.1 * actuator.limits.velocity


def _visit(
    actuator: Actuator, levels: Iterator[float], time: FloatArray, start: float, dwell: float, speed: float = _SPEED
) -> list[Move]:
    """Return the moves from level to level, each as fast as the limits allow, that end before the time does."""
    moves: list[Move] = []
    here, at, end = 0.0, start, float(time[-1]) - 0.05
    for level in levels:
        distance = level - here
        limits = actuator.limits
        duration = max(0.05, shortest_move(distance, speed * limits.velocity, _ACCELERATION * limits.acceleration))
        if at + duration > end:
            break
        moves.append(Move(at, duration, distance))
        here, at = level, at + duration + dwell
    return moves


def reversals(robot: Robot, time: FloatArray, scale: float) -> Tracks:
    """Return growing reversals with dwell, (n, k): from ten micrometres, where friction sticks, to full strokes."""
    stairs = np.array([0.008, 0.016, 0.032, 0.08, 0.2, 0.45, 0.9])

    def levels(j: int) -> Iterator[float]:
        order = itertools.cycle(np.roll(stairs, -2 * j) if j else stairs)
        for step in order:
            yield from (step * scale, -step * scale)

    tracks = []
    for j, actuator in enumerate(robot.actuators):
        unit = (1 - 2 * (j % 2)) * _unit(actuator)
        moves = _visit(actuator, (unit * x for x in levels(j)), time, 0.22 + 0.07 * j, 0.11 + 0.015 * j, 0.5)
        tracks.append(move_track(time, moves))
    return _columns(tracks)


def sweep(robot: Robot, time: FloatArray, scale: float) -> Tracks:
    """Return out-and-back strokes (n, k) at four constant speeds, beyond one motor revolution at the fast ones."""
    speeds = np.array([0.09, 0.34, 0.58, 0.17])
    period = 1.06
    tracks = []
    for j, actuator in enumerate(robot.actuators):
        sign, start = 1 - 2 * (j % 2), 0.2 + 0.05 * j
        # a revolute axis would need more than its acceleration to turn round at those speeds in time
        top = actuator.limits.velocity * scale * (0.5 if actuator.kind == "revolute" else 1.0)
        changes: list[SpeedChange] = []
        for n, speed in enumerate(itertools.cycle(np.roll(speeds, -j))):
            at, v = start + n * period, sign * top * speed
            if at + period > time[-1] - 0.05:
                break
            blend = max(0.04, shortest_speed_change(2 * v, _ACCELERATION * actuator.limits.acceleration))
            half = (period - blend) / 2
            changes += [SpeedChange(at, blend, v), SpeedChange(at + half, blend, -2 * v)]
            changes.append(SpeedChange(at + 2 * half, blend, v))
        tracks.append(speed_track(time, changes))
    return _columns(tracks)


_LEVELS = (0.05, -0.17, 0.1, -0.08, 0.17, -0.35, 0.27, -0.04, 0.35, 0.0, -0.25, 0.2, -0.02, 0.12)


def steps(robot: Robot, time: FloatArray, scale: float) -> Tracks:
    """Return moves (n, k) of many sizes, as fast as velocity and acceleration limits allow, with time to settle."""
    tracks = []
    for j, actuator in enumerate(robot.actuators):
        levels = (_unit(actuator) * scale * x for x in itertools.cycle(np.roll(_LEVELS, 3 * j)))
        moves = _visit(actuator, levels, time, 0.24 + 0.06 * j, 0.28 + 0.04 * j)
        tracks.append(move_track(time, moves))
    return _columns(tracks)


def jumps(robot: Robot, time: FloatArray, scale: float) -> Tracks:
    """Return set-points (n, k) that jump, as a simple host would send them; the robot's graph refuses them."""
    position = np.zeros((len(time), len(robot.actuators)))
    for j, actuator in enumerate(robot.actuators):
        dwell, start = 0.33 + 0.03 * j, 0.25 + 0.06 * j
        index = np.floor((time - start) / dwell).astype(int)
        levels = np.roll(_LEVELS, 3 * j)[index % len(_LEVELS)]
        position[:, j] = np.where(index < 0, 0.0, 0.55 * _unit(actuator) * scale * levels)
    return position, np.zeros_like(position)


def hold(robot: Robot, time: FloatArray, scale: float) -> Tracks:
    """Return the posture held still, zeros (n, k): the motion of a run whose excitation is its loads."""
    return np.zeros((len(time), len(robot.actuators))), np.zeros((len(time), len(robot.actuators)))


_VISITS = (
    (1.3, -2.0, 0.4, 1.4, 3.2),
    (2.1, -1.6, 0.9, 1.6, 3.6),
    (-1.9, 1.3, 2.4, -1.5, -3.4),
    (-1.5, 1.7, 2.0, -1.9, -2.9),
    (0.5, 2.2, -1.2, 0.4, -1.8),
    (0.9, 2.6, -0.8, 0.8, 1.2),
)


def postures(robot: Robot, time: FloatArray, scale: float) -> Tracks:
    """Return wide moves (n, k) between postures, each corrected by small moves from both sides."""
    tracks = []
    for j, actuator in enumerate(robot.actuators):
        unit = _unit(actuator) * scale
        near = (0.0, 0.35, 0.0, -0.35)
        levels = (unit * (visit[j] + offset) for visit in itertools.cycle(_VISITS) for offset in near)
        tracks.append(move_track(time, _visit(actuator, levels, time, 0.2 + 0.02 * j, 0.1 + 0.02 * j, 0.88)))
    return _columns(tracks)


def task(robot: Robot, time: FloatArray, scale: float) -> Tracks:
    """Return slow smooth combined motion (n, k) of all axes, as in an insertion, with a contact on the way."""
    end = float(time[-1])
    rise, rise_slope = move_track(time, [Move(0.0, 0.9, 1.0), Move(end - 0.95, 0.9, -1.0)])
    tracks = []
    for j, actuator in enumerate(robot.actuators):
        rng = np.random.default_rng(31 + j)  # fixed: the task is the same motion in every run
        q, v = np.zeros_like(time), np.zeros_like(time)
        for frequency in (0.13, 0.23, 0.41):
            omega = 2 * np.pi * frequency * rng.uniform(0.85, 1.15)
            phase, size = rng.uniform(0, 2 * np.pi), 0.1 * _unit(actuator) * scale / frequency
            q += size * (np.sin(omega * time + phase) - np.sin(phase))
            v += size * omega * np.cos(omega * time + phase)
        tracks.append((rise * q, rise * v + rise_slope * q))
    return _columns(tracks)


def load_plateaus(time: FloatArray, scale: float) -> tuple[Load, ...]:
    """Return known loads along +x, -x, +y, -y, +z, -z of {b}, six plateaus that share the times (n,) [s]."""
    directions = ((1.2, 0, 0), (-1.2, 0, 0), (0, 1.0, 0), (0, -1.0, 0), (0, 0, 0.8), (0, 0, -0.8))
    period = (float(time[-1]) - 0.4) / len(directions)
    loads = []
    for n, (x, y, z) in enumerate(directions):
        start = 0.36 + n * period
        loads.append((round(start, 3), round(start + 0.52 * period, 3), scale * x, scale * y, scale * z))
    return tuple(loads)


def task_loads(time: FloatArray, scale: float) -> tuple[Load, ...]:
    """Return two contacts during the task at times (n,) [s], as a tool meets tissue."""
    end = float(time[-1])
    first = (round(0.34 * end, 3), round(0.56 * end, 3), 0.0, 0.24 * scale, 0.1 * scale)
    second = (round(0.7 * end, 3), round(0.9 * end, 3), 0.2 * scale, -0.1 * scale, 0.28 * scale)
    return (first, second)


def no_loads(time: FloatArray, scale: float) -> tuple[Load, ...]:
    """Return no load at any of the times (n,)."""
    return ()


MotionFunction = Callable[[Robot, FloatArray, float], Tracks]
LoadFunction = Callable[[FloatArray, float], tuple[Load, ...]]
