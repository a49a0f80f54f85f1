"""Labelled evidence in bulk: cases that are drawn, simulated and diagnosed in memory, of which the evidence is kept.

Such a case has the robot, the runs and the faults of a sealed one. It is cheaper: no bags, no reports, no oracle, and a
fault is brought to its size on two excitations.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import count
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


def draw(plants: Iterable[str], seeds: Iterable[int], kept: Path) -> Iterator[list[Observation]]:
    """Yield the observations of drawn cases, plants and kinds dealt in turn; those in `kept` are not computed again."""
    dealt, robot = list(plants), load_robot()
    for n, seed in zip(count(), seeds, strict=False):
        plant, kind = dealt[n % len(dealt)], TURN[n // len(dealt) % len(TURN)]
        file = kept / plant / f"drawn_{seed:05d}.json"
        found = stored(file)
        if not found:
            found = evidence_of(robot, plant, kind, seed)
            keep(found, file)
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
