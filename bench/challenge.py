"""Building sealed cases: seconds of one core per case and per simulated run of a truth plant.

python bench/challenge.py                  # six cases of the lumped plant
python bench/challenge.py --plant tables --json
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from pathlib import Path

from sher3_challenge.cases.builder import Request, build_case
from sher3_challenge.cases.plan import draw_plan
from sher3_challenge.plants.registry import plant_names, truth_plant
from sher3_description import load_robot


def main() -> None:
    """Print or dump the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--cases", type=int, default=6)
    parser.add_argument("--plant", default="lumped", choices=plant_names())
    arguments = parser.parse_args()
    robot = load_robot()
    plan = draw_plan(robot, 1, truth_plant(arguments.plant))
    plant = plan.healthy(robot)
    plant.run(plan.runs[0])  # compiles
    started = time.process_time()
    for run in plan.runs:
        plant.run(run)
    per_run = (time.process_time() - started) / len(plan.runs)
    seconds = []
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(arguments.cases):
            started = time.process_time()
            build_case(Request(seed, plant=arguments.plant), Path(folder), robot)
            seconds.append(time.process_time() - started)
    figures = {
        "seconds_per_run": per_run,
        "simulated_seconds_per_run": len(plan.runs[0].excitation.position) * robot.control_period,
        "seconds_per_case": sum(seconds) / len(seconds),
        "slowest_case": max(seconds),
    }
    print(json.dumps(figures) if arguments.json else "\n".join(f"{k:28s}{v:8.3f}" for k, v in figures.items()))


if __name__ == "__main__":
    main()
