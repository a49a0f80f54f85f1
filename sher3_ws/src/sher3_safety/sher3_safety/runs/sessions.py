"""What a healthy robot is asked to do: surgeons of every strength drawn from seeds, and the standard excitations."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from sher3_bringup.surgeon.script import Script
from sher3_description import Robot
from sher3_gap.excitation import catalogue, excite

Array = NDArray[np.float64]
SESSION = 60.0
"""Length of one session, s."""
WEAKEST, STRONGEST, TREMOR = 0.05, 6.0, 12.0
"""Forces of a hand, N: less than what moves the robot, and what a hand that is in a hurry pushes with; the fastest
tremor, Hz."""
ACROSS, TORQUE = 2.5, 0.012
"""Most that it pushes across the tool, N, and turns it, N m: more saturates the moment of the force sensor."""
BETWEEN = 1.5
"""Time from the end of one excitation to the beginning of the next, s."""


def surgeon(seed: int) -> Script:
    """Return a surgeon drawn from a seed; every push is taken back, so that the tip stays in the workspace."""
    draw = np.random.default_rng([seed, 0x5EED])
    steps: list[dict[str, Any]] = [
        {"name": "settle", "duration": 0.3},
        {"name": "enable", "duration": 0.4, "command": "enable"},
    ]
    time = 0.7
    while time < SESSION - 8.0:
        strength = float(np.exp(draw.uniform(np.log(WEAKEST), np.log(STRONGEST))))
        force = draw.standard_normal(3)
        force *= strength / np.linalg.norm(force)
        force[:2] = np.clip(force[:2], -ACROSS, ACROSS)
        torque = draw.uniform(-TORQUE, TORQUE, 3) * min(1.0, strength / ACROSS)
        length, ramp, pedal = draw.uniform(0.5, 2.0), draw.uniform(0.02, 0.5), draw.uniform(0.4, 1.0)
        push = {"duration": length, "ramp": ramp, "pedal": pedal}
        wrench = np.concatenate([force, torque])
        sine = {"dither": (0.3 * wrench * draw.uniform(0.0, 1.0, 6)).tolist(), "frequency": draw.uniform(0.5, TREMOR)}
        steps += [
            {"name": "push", "wrench": wrench.tolist(), **push, **sine},
            {"name": "back", "wrench": (-wrench).tolist(), **push},
            {"name": "hold", "duration": draw.uniform(0.1, 0.6), "pedal": pedal, "ramp": ramp},
            {"name": "release", "duration": draw.uniform(0.1, 0.5), "wrench": (0.3 * wrench).tolist(), "ramp": 0.02},
        ]
        time += sum(step["duration"] for step in steps[-4:])
    steps.append({"name": "leave", "duration": max(0.5, SESSION - time)})
    return Script.model_validate({"schema": "sher3.teleop/1", "steps": steps})


def excitations(robot: Robot, seed: int) -> tuple[Array, Array]:
    """Return set-points (n, 5) and wrenches on the tip (n, 6) of standard excitations in a row, one a tick.

    The first one begins at zero; from each to the next the set-points go smoothly.
    """
    draw, labels = np.random.default_rng([seed, 0xE8C1]), list(catalogue())
    share = 0.5 - 0.5 * np.cos(np.pi * np.linspace(0.0, 1.0, round(BETWEEN / robot.control_period)))[:, None]
    goals: list[Array] = [np.zeros((1, 5))]
    wrenches: list[Array] = [np.zeros((1, 6))]
    while sum(map(len, goals)) * robot.control_period < SESSION:
        made = excite(labels[draw.integers(len(labels))], robot)
        way: Array = goals[-1][-1] + share * (made.position[0] - goals[-1][-1])
        goals += [way, np.asarray(made.position, dtype=np.float64)]
        wrenches += [np.zeros((len(way), 6)), np.asarray(made.contact_wrench(), dtype=np.float64)]
    return np.concatenate(goals), np.concatenate(wrenches)
