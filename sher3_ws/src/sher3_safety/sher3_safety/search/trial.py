"""One trial: a robot in stepped time, some faults, and how far its tip gets off its way."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from sher3_common.operating_state import StateCommand
from sher3_description import Robot
from sher3_drivers.drive.motor_driver import MotorDriver
from sher3_faults.kinds import OK
from sher3_faults.requests import make_request
from sher3_runtime import Graph

from sher3_safety.runs.stepped import APPROACH, SETTLE, MatrixRun
from sher3_safety.search.draw import ONSETS, Draw

WATCHED = ONSETS + 90
"""Ticks that the tip is watched: the latest onset, and 0.18 s in which a robot that stops comes to rest."""
BEFORE = 20
"""Ticks over which the speed of the tip is taken before the first fault."""


class Found(NamedTuple):
    """What came of a draw: largest distance of the tip from its way [m], first reason of the driver."""

    draw: Draw
    travel: float
    reason: str

    @property
    def share(self) -> float:
        """Travel as a share of its budget."""
        return self.travel / self.draw.budget


def try_all(draws: Sequence[Draw], robot: Robot, seed: int) -> Iterator[Found]:
    """Try draws of one regime, with a new robot where one cannot be recovered."""
    left = list(draws)
    while left:
        with Graph(period=robot.control_period, middleware=False) as graph:
            run = MatrixRun(graph, robot, seed, regime=left[0].regime.value)
            ready = run.start()
            while ready and left:
                yield _try(run, left.pop(0))
                ready = recover(run)


def _try(run: MatrixRun, draw: Draw) -> Found:
    """Play a draw; the way of the tip is straight on at its speed until the robot is told to rest."""
    operator, state = run.operator, draw.state
    operator.force, operator.pedal = state.force, state.pedal
    run.graph.step(APPROACH)
    if draw.paused:
        operator.command(StateCommand.PAUSE.value)
        run.graph.step(SETTLE)

    def begin() -> None:
        for fault in draw.faults:
            run.inject(fault.request(draw.regime, run.rig.robot.control_period).to_json())

    return Found(draw, *off_its_way(run, begin, WATCHED))


def off_its_way(run: MatrixRun, begin: Callable[[], None], ticks: int, leaves: bool = False) -> tuple[float, str]:
    """Return how far the tip gets off its way [m] within some ticks of what begins, and the driver's first reason.

    Its way is straight on, at the speed before, until the driver is told zero or stops; where the hand `leaves`, the
    way ends there.
    """
    plant, driver = run.rig.plant.plant, run.rig.motor_driver.driver
    before = plant.true_tip[1]
    run.graph.step(BEFORE)
    way, farthest = np.array(plant.true_tip[1]), 0.0
    step = (way - before) / BEFORE * (not leaves)
    begin()
    going = _going(driver)
    for _ in run.graph.steps(ticks):
        way = way + step * going
        farthest = max(farthest, float(np.linalg.norm(plant.true_tip[1] - way)))
        going = _going(driver)
    first = driver.stop.first
    return farthest, first.reason.name if first else run.operator.state


def _going(driver: MotorDriver) -> bool:
    """Return whether the drives are told to move, and the driver has not stopped them."""
    return driver.stop.first is None and any(driver.watches.motion.demand.newest)


def recover(run: MatrixRun) -> bool:
    """End all faults, lead the tip back, and enable the robot again; return whether it is."""
    run.inject(make_request(component="all", fault=OK).to_json())
    run.operator.pedal = 0.0
    run.operator.force = 0.0
    run.graph.step(SETTLE)
    run.operator.command(StateCommand.DISABLE.value)
    run.graph.step(SETTLE)
    return run.enable()
