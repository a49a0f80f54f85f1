"""What a healthy robot is asked to do: tools, surgeons of every strength, and the standard excitations, from seeds."""

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
WORKED = 17.0
"""Time of pushes from one change of the tool to the next, s."""
TARE, REST = "tare", 1.5
"""Step in which nobody touches the tool and the force sensor is tared, and its length, s: the tare's window is half a
second, and the hand takes 0.2 s to leave."""
LIGHTEST, HEAVIEST = 0.008, 0.04
"""Mass of a tool outboard of the force sensor, kg: a bare needle in its holder, and a powered instrument."""


def with_tool(robot: Robot, seed: int) -> Robot:
    """Return the robot with a tool drawn from a seed, which its description knows: mass and centre of mass."""
    draw = np.random.default_rng([seed, 0x7001])
    sensor = robot.force_sensor
    centre = (*draw.uniform(-0.002, 0.002, 2).tolist(), float(-draw.uniform(0.01, 0.04)))
    held = sensor.model_copy(update={"tool_mass": float(draw.uniform(LIGHTEST, HEAVIEST)), "tool_com": centre})
    return robot.model_copy(update={"force_sensor": held})


def surgeon(seed: int) -> Script:
    """Return a surgeon drawn from a seed; every push is taken back, so that the tip stays in the workspace.

    After each 17 s of pushes the surgeon changes the tool.
    """
    draw = np.random.default_rng([seed, 0x5EED])
    enable = {"name": "enable", "duration": 0.4, "command": "enable"}
    steps: list[dict[str, Any]] = [{"name": "settle", "duration": 0.3}, enable]
    time, changed = 0.7, 0.7
    while time < SESSION - 8.0:
        new = _pushed(draw)
        if time - changed > WORKED:
            new += [*_tool_changed(draw), enable]
            changed = time
        steps += new
        time += sum(step["duration"] for step in new)
    steps.append({"name": "leave", "duration": max(0.5, SESSION - time)})
    return Script.model_validate({"schema": "sher3.teleop/1", "steps": steps})


def _pushed(draw: np.random.Generator) -> list[dict[str, Any]]:
    """Return the steps of a push, with a tremor on it, and of its way back."""
    strength = float(np.exp(draw.uniform(np.log(WEAKEST), np.log(STRONGEST))))
    force = draw.standard_normal(3)
    force *= strength / np.linalg.norm(force)
    force[:2] = np.clip(force[:2], -ACROSS, ACROSS)
    torque = draw.uniform(-TORQUE, TORQUE, 3) * min(1.0, strength / ACROSS)
    length, ramp, pedal = draw.uniform(0.5, 2.0), draw.uniform(0.02, 0.5), draw.uniform(0.4, 1.0)
    push = {"duration": length, "ramp": ramp, "pedal": pedal}
    wrench = np.concatenate([force, torque])
    sine = {"dither": (0.3 * wrench * draw.uniform(0.0, 1.0, 6)).tolist(), "frequency": draw.uniform(0.5, TREMOR)}
    return [
        {"name": "push", "wrench": wrench.tolist(), **push, **sine},
        {"name": "back", "wrench": (-wrench).tolist(), **push},
        {"name": "hold", "duration": draw.uniform(0.1, 0.6), "pedal": pedal, "ramp": ramp},
        {"name": "release", "duration": draw.uniform(0.1, 0.5), "wrench": (0.3 * wrench).tolist(), "ramp": 0.02},
    ]


def _tool_changed(draw: np.random.Generator) -> list[dict[str, Any]]:
    """Return the steps of a tool that is taken off and put on again: a hand pulls at it without power, then a tare."""
    pulled = np.concatenate([draw.uniform(-ACROSS, ACROSS, 3), draw.uniform(-TORQUE, TORQUE, 3)])
    return [
        {"name": "let go", "duration": 0.5},
        {"name": "disable", "duration": 0.3, "command": "disable"},
        {"name": "change the tool", "duration": draw.uniform(0.5, 1.5), "wrench": pulled.tolist()},
        {"name": TARE, "duration": REST},
    ]


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
