"""Trials: a robot in stepped time that has come to a state, what begins there, and how far its tip gets off its way."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_common.operating_state import OperatingState, StateCommand
from sher3_control.motion.speed_cap import Regime
from sher3_description import Robot
from sher3_drivers.drive.motor_driver import MotorDriver
from sher3_runtime import Graph

from sher3_safety.rows.row import State
from sher3_safety.runs.stepped import APPROACH, SETTLE, MatrixRun
from sher3_safety.search.draw import ONSETS, Draw
from sher3_safety.search.forked import forked

Array = NDArray[np.float64]
WATCHED = ONSETS + 90
"""Ticks that the tip is watched: the latest onset, and 0.18 s in which a robot that stops comes to rest."""
BEFORE = 20
"""Ticks over which the speed of the tip is taken before the first fault."""


class Found(NamedTuple):
    """What came of a draw: how far the tip got off its way [m], first reason of the driver, seed of the robot."""

    draw: Draw
    travel: float
    reason: str
    seed: int

    @property
    def share(self) -> float:
        """Travel as a share of its budget."""
        return self.travel / self.draw.budget


class Trial(NamedTuple):
    """What `begin` does to a robot in a state of a regime, and how many ticks it is watched then.

    The way of the tip is straight on, at the speed before; where the hand `leaves`, it ends there.
    """

    begin: Callable[[MatrixRun], None]
    state: State
    regime: Regime
    ticks: int = WATCHED
    leaves: bool = False


def try_all(draws: Sequence[Draw], robot: Robot, seed: int) -> list[Found]:
    """Try draws, each on a robot of that seed as it comes to the state of the draw."""
    trials = [Trial(partial(_inject, draw), draw.state, draw.regime) for draw in draws]
    return [Found(draw, *came, seed) for draw, came in zip(draws, play(trials, robot, seed), strict=True)]


def _inject(draw: Draw, run: MatrixRun) -> None:
    for fault in draw.faults:
        run.inject(fault.request(draw.regime, run.rig.robot.control_period).to_json())


def play(trials: Sequence[Trial], robot: Robot, seed: int) -> list[tuple[float, str]]:
    """Return how far the tip gets off its way [m] in each trial, and the driver's first reason.

    One robot comes to each state of each regime; every trial there is played in a fork of it, so none knows of another.
    """
    came = dict[int, tuple[float, str]]()
    for regime, state in dict.fromkeys((trial.regime, trial.state) for trial in trials):
        with Graph(period=robot.control_period, middleware=False) as graph:
            run = MatrixRun(graph, robot, seed, regime=regime.value)
            before = _come_to(run, state)
            for number, trial in enumerate(trials):
                if (trial.regime, trial.state) == (regime, state):
                    came[number] = forked(partial(_off_its_way, run, trial, before))
    return [came[number] for number in range(len(trials))]


def _come_to(run: MatrixRun, state: State) -> Array:
    """Lead a new robot to a state; return where its tip was `BEFORE` ticks ago [m]."""
    run.start()
    operator = run.operator
    operator.force, operator.across, operator.pedal = state.force, state.across, state.pedal
    run.graph.step(APPROACH)
    if state.operating is OperatingState.PAUSED:
        operator.command(StateCommand.PAUSE.value)
        run.graph.step(SETTLE)
    before: Array = run.rig.plant.plant.true_tip[1]
    run.graph.step(BEFORE)
    return before


def _off_its_way(run: MatrixRun, trial: Trial, before: Array) -> tuple[float, str]:
    """Play a trial; the tip's way goes on until the driver is told zero or stops."""
    plant, driver = run.rig.plant.plant, run.rig.motor_driver.driver
    way, farthest = np.array(plant.true_tip[1]), 0.0
    step = (way - before) / BEFORE * (not trial.leaves)
    trial.begin(run)
    going = _going(driver)
    for _ in run.graph.steps(trial.ticks):
        way = way + step * going
        farthest = max(farthest, float(np.linalg.norm(plant.true_tip[1] - way)))
        going = _going(driver)
    first = driver.stop.first
    return farthest, first.reason.name if first else run.operator.state


def _going(driver: MotorDriver) -> bool:
    """Return whether the drives are told to move, and the driver has not stopped them."""
    return driver.stop.first is None and any(driver.watches.motion.demand.newest)
