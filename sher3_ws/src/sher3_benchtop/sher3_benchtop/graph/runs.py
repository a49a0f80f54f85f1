"""The bench-top evaluation on the graph: each test a session of its own in stepped time, recorded and evaluated."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path

from sher3_bags.reading import read_run
from sher3_bags.recording.live import recorded
from sher3_bringup.stepped_robot import SteppedRobot
from sher3_common.progress import Say, silent
from sher3_control.settings import ControlSettings
from sher3_description import Robot
from sher3_runtime import Graph
from sher3_sim import PlantEffect

from sher3_benchtop.cameras.pictures import Shots, taken
from sher3_benchtop.errors import BenchtopStopped
from sher3_benchtop.graph.benchtop_node import START, BenchtopNode
from sher3_benchtop.protocol.plan import Plan, planned
from sher3_benchtop.protocol.timeline import Timeline

PART = 250
"""Ticks between two looks at whether the robot still does as commanded."""


def run_timeline(
    timeline: Timeline,
    robot: Robot,
    effects: Sequence[PlantEffect],
    folder: Path,
    control: ControlSettings | None = None,
    seed: int = 1,
) -> dict[str, Shots]:
    """Run one test on a new graph, record it into `folder/<name>`, and return its pictures by group.

    Args:
        timeline: of the test.
        robot: on the bench, see `sher3_benchtop.fixture.bench_robot`.
        effects: of the plant.
        folder: of the bags; a former bag of the test is replaced.
        control: settings of the control nodes.
        seed: of the plant's noise.

    Raises:
        BenchtopStopped: a command was refused, or the robot stopped.
    """
    with Graph(period=robot.control_period, middleware=False) as graph:
        bench = graph.add(BenchtopNode, timeline, robot)
        SteppedRobot(graph, effects, seed, robot, control)
        with recorded(graph, timeline.name, robot=robot, root=folder) as recorder:
            left = START + len(timeline)
            while left > 0 and not bench.objection:
                graph.step(min(left, PART))
                left -= PART
        if bench.objection:
            raise BenchtopStopped(timeline.name, bench.objection)
    return recorded_shots(timeline, recorder.recorder.folder, robot)


def recorded_shots(timeline: Timeline, bag: Path, robot: Robot) -> dict[str, Shots]:
    """Return the pictures by group from the bag of a test; its first command is the timeline's first tick.

    Raises:
        MissingTopicError, BadData: the bag is not of that test, or ends before it.
    """
    run = read_run(bag)
    first = int(run[f"command/{timeline.mode}"].stamp[0])
    return taken(timeline, run["tracker/measured_cp"], first, robot.control_period, robot)


def run_tests(
    names: Iterable[str],
    robot: Robot,
    plan: Plan,
    effects: Sequence[PlantEffect],
    folder: Path,
    control: ControlSettings | None = None,
    say: Say = silent,
    again: bool = False,
    jobs: int = 1,
) -> dict[str, dict[str, Shots]]:
    """Check all tests, then run them, `jobs` at a time in processes; return the pictures by test and group.

    With `again` nothing runs: the bags of a former run of the same plan are read.

    Raises:
        Unreachable, OutsideLimits, LoadBeyondRange: a test asks for too much; nothing has moved.
        BenchtopStopped: see `run_timeline`.
    """
    timelines = [planned(name, robot, plan) for name in names]
    if again:
        return {timeline.name: recorded_shots(timeline, folder / timeline.name, robot) for timeline in timelines}
    for timeline in timelines:
        seconds = len(timeline) * robot.control_period
        say(f"{timeline.name}: {len(timeline.pictures)} pictures in {seconds:.0f} s of the robot's time")
    run = partial(run_timeline, robot=robot, effects=effects, folder=folder, control=control)
    if jobs == 1:
        return {timeline.name: run(timeline) for timeline in timelines}
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        longest_first = sorted(timelines, key=len, reverse=True)
        found = dict(zip((timeline.name for timeline in longest_first), pool.map(run, longest_first), strict=True))
    return {timeline.name: found[timeline.name] for timeline in timelines}
