"""How often a robot stops of which nothing is broken: healthy running in stepped time.

The tool is drawn, and the force sensor is tared first. Of four sessions three have a surgeon drawn from a seed (reach,
hold, dither, turn, release, press again, tremble at up to 12 Hz, 0.05 to 6 N), two in the regime `free` and one in
`near_tissue`; twice in a session the surgeon disables the robot, changes the tool, tares and enables again. The
fourth session has the standard excitations on the bench. The mocks are strict, the plant has run-to-run scatter, its
temperature goes up and down, and force sensor and structure drift with it. Whatever stops the robot without anybody
asking for it is a false trip, and so is a tare or an `enable` that is refused.
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from itertools import pairwise
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from sher3_bags.reading import read_run
from sher3_bags.recording.live import recorded
from sher3_bags.run import Run, RunMetadata
from sher3_bringup.stepped_robot import SteppedRobot
from sher3_bringup.surgeon.script import Script
from sher3_bringup.surgeon.teleop_node import script_node
from sher3_common.operating_state import OperatingState, StateCommand
from sher3_control.settings import ControlSettings
from sher3_description import load_robot
from sher3_drivers.settings import default_settings
from sher3_effects import plants
from sher3_runtime import Graph
from sher3_sim.scatter import RunScatter

from sher3_safety.kept import Kept
from sher3_safety.measurement.recording import INTENDED
from sher3_safety.measurement.report import false_trips
from sher3_safety.runs.excitation_node import ExcitationNode
from sher3_safety.runs.operator_node import tare
from sher3_safety.runs.sessions import REST, SESSION, TARE, excitations, surgeon, with_tool

RECORDED = ("supervisor/status", "admittance/status", "motion/status", "operating_state", "mock/pedal", "measured_cp")
KEPT = "healthy.jsonl"
"""File of the sessions that are kept, a line of JSON each."""
REGIMES = ("bench", "near_tissue", "free", "free")
"""Regimes of the sessions in turn; on the bench there are excitations instead of a surgeon."""
WARM, SWING, WARMING = 23.0, 5.0, 240.0
"""Mean temperature of the structure, its swing, degC, and the period of that, s."""
STRETCH = 250
"""Ticks from one temperature to the next."""


def run_healthy(
    folder: Path, minutes: float, seed: int, jobs: int, say: Callable[[str], None], kept: Path | None = None
) -> dict[str, Any]:
    """Run so many minutes of sessions; return trips, hours, the rate per hour, its bound, and the time that it took.

    Args:
        folder: bags go to `folder/healthy-<seed>`.
        minutes: of the robot's time.
        seed: of the first session; each further one has the next.
        jobs: processes at a time.
        say: prints progress.
        kept: folder of what earlier sessions came to, which are not run again, and of what these come to.
    """
    seeds = range(seed, seed + max(1, round(minutes * 60.0 / SESSION)))
    store = Kept(kept, KEPT)
    begin, found = time.monotonic(), {entry["seed"]: entry["trips"] for entry in store.before()}
    left = [number for number in seeds if number not in found]
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        for number, trips in zip(left, pool.map(run_session, [folder] * len(left), left), strict=True):
            found[number] = trips
            store.add([{"seed": number, "trips": trips}])
            so_far = [trip for done in seeds for trip in found.get(done, [])]
            say(f"healthy: seed {number}, {len(so_far)} trips so far" + (f", last: {so_far[-1]}" if so_far else ""))
    what = [trip for number in seeds for trip in found[number]]
    lasted = {"what": what, "seeds": [seeds[0], seeds[-1]], "seconds": time.monotonic() - begin}
    return {**false_trips(len(what), len(seeds) * SESSION / 3600.0), **lasted}


def run_session(folder: Path, seed: int) -> list[str]:
    """Run one session and return its trips, most of them read from its bag."""
    robot = with_tool(load_robot(), seed)
    regime = REGIMES[seed % len(REGIMES)]
    control = ControlSettings.from_robot(robot, {"motion": {"regime": regime}})
    with Graph(period=robot.control_period, middleware=False) as graph:
        rig = SteppedRobot(
            graph,
            _climate(),
            seed,
            robot,
            control,
            RunScatter(),
            default_settings(robot.control_period),
        )
        rig.plant.plant.temperature = temperature(seed, 0.0)
        graph.step(STRETCH)
        tare(graph)
        script = None if regime == "bench" else surgeon(seed)
        if script is None:
            graph.add(ExcitationNode, *excitations(robot, seed))
        else:
            graph.add(script_node, script)
        metadata = RunMetadata(excitation="healthy", origin="plant", seed=seed)
        name = f"healthy-{seed}"
        with recorded(graph, name, topics=RECORDED, robot=robot, root=folder, metadata=metadata):
            refused = _lasts(graph, rig, seed, script)
    enables = 1 if script is None else sum(step.command == StateCommand.ENABLE for step in script.steps)
    return refused + trips_of(read_run(folder / name, check=False), enables)


def _lasts(graph: Graph, rig: SteppedRobot, seed: int, script: Script | None) -> list[str]:
    """Let a session go by, with its temperatures and a tare in each step for one; return the tares refused."""
    period, refused, tared = rig.robot.control_period, [], -1
    for start in range(0, round(SESSION / period), STRETCH):
        now = start * period
        rig.plant.plant.temperature = temperature(seed, now)
        graph.step(STRETCH)
        index, since = script.step_at(now + STRETCH * period) if script else (-1, 0.0)
        if script and script.steps[index].name == TARE and index != tared and since > 0.5 * REST:
            tared, answer = index, tare(graph)
            refused += [] if answer.success else [f"tare refused: {answer.message}"]
    return refused


def temperature(seed: int, time: float) -> float:
    """Return the temperature of the structure [degC] at a time of a session [s]."""
    return WARM + SWING * math.sin(2.0 * math.pi * (time / WARMING + 0.1 * seed))


def _climate() -> list[Any]:
    """Return what changes with the temperature of a healthy robot."""
    effects = plants()
    return [effects["force_drift"](actuator="force_sensor"), effects["thermal_expansion"](actuator="tip")]


def trips_of(run: Run, enables: int = 1) -> list[str]:
    """Return what stopped the robot while it was enabled and nobody asked for it, and how often it was not enabled.

    Args:
        run: with the topics `RECORDED`.
        enables: how often it was asked to be.
    """
    states = [(int(s), json.loads(text)) for s, text in zip(*_text(run, "supervisor/status"), strict=True)]
    trips = [str(data["reason"]) for (_, before), (_, data) in pairwise(states) if _fell(before, data)]
    enabled = [
        stamp
        for (_, before), (stamp, data) in pairwise(states)
        if before["state"] != data["state"] == OperatingState.ENABLED
    ]
    for topic in ("admittance/status", "motion/status"):
        reasons = [(int(s), json.loads(text)["reason"]) for s, text in zip(*_text(run, topic), strict=True)]
        trips += [reason for stamp, reason in reasons if enabled and stamp > enabled[0] and reason not in INTENDED]
    return ["not enabled"] * (enables - len(enabled)) + trips


def _fell(before: dict[str, Any], after: dict[str, Any]) -> bool:
    return before["state"] != after["state"] and after["state"] in (OperatingState.FAULT, OperatingState.PAUSED)


def _text(run: Run, topic: str) -> tuple[Any, Any]:
    return run[topic].stamp, run[topic].data
