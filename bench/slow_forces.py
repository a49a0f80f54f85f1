"""A force sensor that is alive and wrong under a true hand: when it is noticed, and where the tip is then.

    python bench/slow_forces.py              # all: a minute and a half of the robot's time
    python bench/slow_forces.py --only gain

Sideways is across the direction of the hand; along it, beside how far a true sensor would have led the tip.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from sher3_description import load_robot
from sher3_faults.requests import make_request
from sher3_runtime import Graph
from sher3_safety.runs.stepped import APPROACH, MatrixRun

ROBOT = load_robot()
PERIOD = ROBOT.control_period
Hand = Callable[[float], float]
"""Force of the hand along z [N] at a time [s]."""


class Case(NamedTuple):
    """A fault of the force sensor under a hand, for so many seconds; it begins when the hand does, or in its hold."""

    name: str
    fault: str
    parameters: dict[str, float]
    hand: Hand
    seconds: float
    regime: str = "near_tissue"


def constant(force: float) -> Hand:
    """Return a hand that stays."""
    return lambda time: force


def grows(force: float, seconds: float) -> Hand:
    """Return a hand that comes slowly."""
    return lambda time: force * min(1.0, time / seconds)


def fades(force: float, rate: float) -> Hand:
    """Return a hand that leaves slowly."""
    return lambda time: max(0.0, force - rate * time)


AT_ONCE, SLOWLY = (constant(1.0), "1 N at once", 3.0), (grows(1.0, 15.0), "1 N over 15 s", 20.0)
CASES = (
    *(
        Case(f"sensor turned by {degrees} deg, {told}", "turn", {"angle": float(np.radians(degrees))}, hand, seconds)
        for hand, told, seconds in (AT_ONCE, SLOWLY)
        for degrees in (10, 20)
    ),
    *(
        Case(f"gain grows by {100 * rate:g} % a second, 0.6 N", "ramp", {"rate": rate}, constant(0.6), 12.0, "free")
        for rate in (0.1, 0.05)
    ),
    Case("sensor stays at 1 N, the hand fades at 0.09 N/s", "held", {}, fades(1.0, 0.09), 12.0),
)  # fmt: skip


def start(graph: Graph, case: Case) -> MatrixRun:
    """Return an enabled robot under the hand of a case, with the pedal pressed."""
    run = MatrixRun(graph, ROBOT, 1, regime=case.regime)
    if not run.start():
        raise SystemExit("the robot is not enabled")
    run.operator.force, run.operator.pedal = case.hand(0.0), 1.0
    graph.step(APPROACH)
    return run


def went(case: Case, fault: bool) -> tuple[float | None, np.ndarray]:
    """Return when the robot stops [s], and how far its tip goes until then, or in the time of the case [m]."""
    with Graph(period=PERIOD, middleware=False) as graph:
        run = start(graph, case)
        plant = run.rig.plant.plant
        if fault:
            run.inject(make_request(component="force_sensor", fault=case.fault, parameters=case.parameters).to_json())
        begin = np.array(plant.true_tip[1])
        for tick in range(round(case.seconds / PERIOD)):
            run.operator.force = case.hand(tick * PERIOD)
            graph.step()
            if run.operator.state != "ENABLED":
                graph.step(APPROACH)
                return tick * PERIOD, np.array(plant.true_tip[1]) - begin
        return None, np.array(plant.true_tip[1]) - begin


def line(case: Case) -> str:
    """Return what came of a case as a line."""
    noticed, way = went(case, fault=True)
    told = "not noticed" if noticed is None else f"noticed after {noticed:.2f} s, hand {case.hand(noticed):.2f} N"
    _, true = went(case._replace(seconds=case.seconds if noticed is None else noticed), fault=False)
    sizes = f"{1e6 * np.hypot(*way[:2]):5.0f} um sideways, {1e3 * way[2]:6.2f} mm along ({1e3 * true[2]:.2f} true)"
    return f"{case.name:48}{case.regime:12}{told:38}{sizes}"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="only those whose name has this in it")
    only = parser.parse_args().only
    for chosen in CASES:
        if only in chosen.name:
            print(line(chosen), flush=True)
