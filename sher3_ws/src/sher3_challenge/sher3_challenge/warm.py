"""Compile the truth plants before a test or a challenge asks for them, as the set-up does for the diagnosis."""

from __future__ import annotations

from sher3_bags import Run
from sher3_description import load_robot
from sher3_gap.excitation import excite

from sher3_challenge.plants.plant import Climate, RunPlan
from sher3_challenge.plants.registry import truth_plants


def warm_up() -> dict[str, Run]:
    """Return a short run of every truth plant that is installed, by name: nothing else has to be compiled."""
    robot = load_robot()
    plan = RunPlan(excite("sweep", robot, duration=2.0), 0, 10**18, 1)
    plants = truth_plants(print)
    return {p.name: p.make(robot, 1, (), Climate(25.0, 0.0, 100.0, 10**18)).run(plan) for p in plants}


if __name__ == "__main__":
    warm_up()
