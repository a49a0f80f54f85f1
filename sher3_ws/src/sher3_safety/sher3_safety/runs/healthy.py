"""How often a robot stops of which nothing is broken: healthy running in stepped time.

Demo-like surgeons drawn from seeds (reach, hold, dither, turn, release, press again) on plants with run-to-run scatter;
whatever stops the robot without the surgeon asking for it is a false trip.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from itertools import pairwise
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from sher3_bags.reading import read_run
from sher3_bags.recording.live import recorded
from sher3_bags.run import Run, RunMetadata
from sher3_bringup.stepped_robot import SteppedRobot
from sher3_bringup.surgeon.script import Script
from sher3_bringup.surgeon.teleop_node import script_node
from sher3_common.operating_state import OperatingState
from sher3_description import load_robot
from sher3_drivers.settings import default_settings
from sher3_runtime import Graph
from sher3_sim.scatter import RunScatter

from sher3_safety.measurement.recording import INTENDED
from sher3_safety.measurement.report import false_trips

SESSION = 60.0
"""Length of one session, s."""
RECORDED = ("supervisor/status", "admittance/status", "motion/status", "operating_state", "mock/pedal", "measured_cp")


def run_healthy(folder: Path, minutes: float, seed: int, jobs: int, say: Callable[[str], None]) -> dict[str, Any]:
    """Run so many minutes of sessions; return trips, hours, the rate per hour and its bound.

    Args:
        folder: bags go to `folder/healthy-<seed>`.
        minutes: of the robot's time.
        seed: of the first session; each further one has the next.
        jobs: processes at a time.
        say: prints progress.
    """
    sessions = max(1, round(minutes * 60.0 / SESSION))
    trips: list[str] = []
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        for found in pool.map(run_session, [folder] * sessions, range(seed, seed + sessions)):
            trips += found
            say(f"healthy: {len(trips)} trips so far" + (f", last: {trips[-1]}" if trips else ""))
    return {**false_trips(len(trips), sessions * SESSION / 3600.0), "what": trips, "seeds": [seed, seed + sessions - 1]}


def run_session(folder: Path, seed: int) -> list[str]:
    """Run one session and return its trips, read from its bag."""
    robot, script = load_robot(), surgeon(seed)
    with Graph(period=robot.control_period) as graph:
        SteppedRobot(graph, seed=seed, robot=robot, scatter=RunScatter(), drives=default_settings(robot.control_period))
        graph.add(script_node, script)
        metadata = RunMetadata(excitation="healthy", origin="plant", seed=seed)
        name = f"healthy-{seed}"
        with recorded(graph, name, topics=RECORDED, robot=robot, root=folder, metadata=metadata):
            graph.step(round(script.duration / robot.control_period))
    return trips_of(read_run(folder / name, check=False))


def surgeon(seed: int) -> Script:
    """Return a surgeon drawn from a seed; every push is taken back, so that the tip stays in the workspace."""
    draw = np.random.default_rng([seed, 0x5EED])
    steps: list[dict[str, Any]] = [
        {"name": "settle", "duration": 0.3},
        {"name": "enable", "duration": 0.4, "command": "enable"},
    ]
    time = 0.7
    while time < SESSION - 8.0:
        force, torque = draw.uniform(-2.5, 2.5, 3), draw.uniform(-0.02, 0.02, 3)
        length, ramp, pedal = draw.uniform(0.5, 2.0), draw.uniform(0.02, 0.5), draw.uniform(0.4, 1.0)
        push = {"duration": length, "ramp": ramp, "pedal": pedal}
        wrench = np.concatenate([force, torque])
        sine = {"dither": (0.3 * wrench * draw.uniform(0.0, 1.0, 6)).tolist(), "frequency": draw.uniform(0.5, 8.0)}
        steps += [
            {"name": "push", "wrench": wrench.tolist(), **push, **sine},
            {"name": "back", "wrench": (-wrench).tolist(), **push},
            {"name": "hold", "duration": draw.uniform(0.1, 0.6), "pedal": pedal, "ramp": ramp},
            {"name": "release", "duration": draw.uniform(0.1, 0.5), "wrench": (0.3 * wrench).tolist(), "ramp": 0.02},
        ]
        time += sum(step["duration"] for step in steps[-4:])
    steps.append({"name": "leave", "duration": max(0.5, SESSION - time)})
    return Script.model_validate({"schema": "sher3.teleop/1", "steps": steps})


def trips_of(run: Run) -> list[str]:
    """Return what stopped the robot while it was enabled and nobody asked for it."""
    states = [(int(s), json.loads(text)) for s, text in zip(*_text(run, "supervisor/status"), strict=True)]
    trips = [str(data["reason"]) for (_, before), (_, data) in pairwise(states) if _fell(before, data)]
    enabled = next((stamp for stamp, data in states if data["state"] == OperatingState.ENABLED), None)
    for topic in ("admittance/status", "motion/status"):
        reasons = [(int(s), json.loads(text)["reason"]) for s, text in zip(*_text(run, topic), strict=True)]
        trips += [reason for stamp, reason in reasons if enabled and stamp > enabled and reason not in INTENDED]
    return trips if enabled else ["never enabled", *trips]


def _fell(before: dict[str, Any], after: dict[str, Any]) -> bool:
    return before["state"] != after["state"] and after["state"] in (OperatingState.FAULT, OperatingState.PAUSED)


def _text(run: Run, topic: str) -> tuple[Any, Any]:
    return run[topic].stamp, run[topic].data
