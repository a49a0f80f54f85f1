"""Labelled evidence in bulk: cases that are drawn, simulated and diagnosed in memory, of which the evidence is kept.

Such a case has the robot, the runs and the faults of a sealed one. It is cheaper: no bags, no reports, no oracle, and a
fault is brought to its size on two excitations.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

from sher3_description import Robot, load_robot

from sher3_challenge.calibration.observe import Observation, keep, observed, stored
from sher3_challenge.cases.builder import described
from sher3_challenge.cases.calibrate import sized
from sher3_challenge.cases.plan import CasePlan, draw_plan
from sher3_challenge.plants.registry import truth_plant

TURN = ("single", "outside", "healthy", "single", "outside", "single", "compound", "outside", "single")
"""Kinds of cases in the order in which they are dealt."""
GAP = (1.5, 25.0)
"""Range of a fault's own gap over the floor."""
ITERATIONS, EXCITATIONS = 2, 2
"""By which a fault is brought to its size; what it has then stands in the label."""


def draw(
    plants: Iterable[str], seeds: Iterable[int], kept: Path, seconds: float = math.inf
) -> Iterator[list[Observation]]:
    """Yield the observations of drawn cases; those in `kept` are not computed again, those of too late not at all.

    A seed by itself says its plant and kind, so that any ranges hold as many of each, and add up.

    Args:
        plants: names, dealt in turn.
        seeds: of the cases.
        kept: folder of their evidence.
        seconds: from now on, after which no case is begun.
    """
    dealt, robot, until = list(plants), load_robot(), time.monotonic() + seconds
    for seed in seeds:
        turn, own = divmod(seed, len(dealt))
        file = kept / dealt[own] / f"drawn_{seed:05d}.json"
        found = stored(file)
        if not found and time.monotonic() < until:
            found = evidence_of(robot, dealt[own], TURN[turn % len(TURN)], seed)
            keep(found, file)
        if found:
            yield found


def plan_of(robot: Robot, plant: str, kind: str, seed: int) -> tuple[CasePlan, dict[str, float]]:
    """Return the plan of one case with its faults brought to size, and their gap over floor by stage and actuator."""
    return sized(draw_plan(robot, seed, truth_plant(plant), kind=kind, gap=GAP), robot, ITERATIONS, EXCITATIONS)


def evidence_of(robot: Robot, plant: str, kind: str, seed: int) -> list[Observation]:
    """Draw, simulate and diagnose one case."""
    from sher3_gap.case.loading import signals_of

    plan, reached = plan_of(robot, plant, kind, seed)
    made = plan.plant(robot)
    runs = [made.run(run) for run in plan.runs]
    truth = {
        **described(plan, made),
        "oracle": {at: {"gap_over_floor": x or None} for at, x in reached.items()},
        "tip": None,
    }
    first = min(run.stamp for run in plan.runs)
    signals = [
        replace(signals_of(run, robot, f"run {i}"), session_time=(p.stamp - first) * 1e-9)
        for i, (run, p) in enumerate(zip(runs, plan.runs, strict=True))
    ]
    return observed(plant, plan.name, truth, signals, robot)
