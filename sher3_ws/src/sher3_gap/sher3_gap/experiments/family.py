"""The family of safe excitations an experiment is chosen from: a staircase of reversals, then known loads at rest.

Its parameters are what tells causes apart on a robot: amplitude, speed, dwell, posture, load. Every member keeps the
limits.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from sher3_description import ACTUATORS, Robot

from sher3_gap.excitation import POSTURES, Excitation, check_limits
from sher3_gap.excitation.profile import FloatArray, Move, move_track, shortest_move
from sher3_gap.excitation.standard import load_plateaus

STAIRS = (0.1, 0.3, 0.6, 1.0)
"""Heights of the reversals, in amplitudes."""
LOADED_SHARE = 0.45
"""Share of the run that belongs to the loads, where there are any."""
Choices = Mapping[str, tuple[Any, ...]]
CHOICES: Choices = {
    "amplitude": (0.02, 0.08, 0.3, 1.0, 1.5),
    "speed": (0.05, 0.2, 0.5, 0.8),
    "dwell": (0.05, 0.2, 0.5),
    "posture": tuple(POSTURES),
    "load": (0.0, 0.5, 1.0),
}


@dataclass(frozen=True)
class Design:
    """One member of the family.

    Attributes:
        amplitude: height of the staircase, in strokes of 0.1 s at the velocity limit (1.22 mm on a slider).
        speed: peak velocity over the limit.
        dwell: rest at each level [s].
        posture: where it starts.
        load: scale of the known tip loads at the end, 0 for none.
        actuator: the one that moves, or all of them.
        duration: of the run [s].
    """

    amplitude: float = 0.3
    speed: float = 0.5
    dwell: float = 0.2
    posture: str = "p0"
    load: float = 0.0
    actuator: str = "all"
    duration: float = 4.6

    def as_dict(self) -> dict[str, float | str]:
        """Return the parameters as plain data."""
        return asdict(self)


def build(design: Design, robot: Robot) -> Excitation:
    """Return the set-points of a design, checked against the limits; raises ExcitationError."""
    time = np.arange(round(design.duration / robot.control_period)) * robot.control_period
    end = design.duration * (1.0 - LOADED_SHARE if design.load else 1.0)
    position, velocity = np.zeros((len(time), 5)), np.zeros((len(time), 5))
    for j, name in enumerate(ACTUATORS):
        if design.actuator in (name, "all"):
            position[:, j], velocity[:, j] = _staircase(design, robot, time, j, end)
    start = np.asarray(POSTURES[design.posture])
    loads = _loads(design, time, end) if design.load else ()
    made = Excitation("experiment", 1.0, design.posture, robot.control_period, start + position, velocity, loads)
    return check_limits(made, robot)


def _staircase(design: Design, robot: Robot, time: FloatArray, axis: int, end: float) -> tuple[FloatArray, FloatArray]:
    """Reversals of growing height until `end`; each axis starts a little later, so that couplings do not look alike."""
    limits = robot.actuators[axis].limits
    stroke = design.amplitude * 0.1 * limits.velocity * (1 - 2 * (axis % 2))
    moves: list[Move] = []
    here, at = 0.0, 0.2 + 0.05 * axis
    while True:
        for level in (s * x for x in STAIRS for s in (1.0, -1.0, 0.0)):
            distance = stroke * level - here
            duration = max(0.04, shortest_move(distance, design.speed * limits.velocity, 0.8 * limits.acceleration))
            if at + duration > end - 0.1:
                return move_track(time, moves)
            moves.append(Move(at, duration, distance))
            here, at = stroke * level, at + duration + design.dwell


def _loads(design: Design, time: FloatArray, end: float) -> tuple[tuple[float, float, float, float, float], ...]:
    """Plateaus along the six directions of {b} after `end`."""
    left = time[time >= end] - end
    return tuple((end + a, end + b, x, y, z) for a, b, x, y, z in load_plateaus(left, design.load))
