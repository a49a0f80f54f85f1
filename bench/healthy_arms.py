"""How often a healthy arm of MuJoCo is called one without a gap: drawn models, servos and motors in turn.

Recorded with controls, with controls and forces, and with forces alone, by names and as arrays.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections import Counter
from pathlib import Path

import mujoco
import numpy as np
import sher3.gap as gap

sys.path.append(str(Path(__file__).parents[1] / "sher3_ws/src/sher3_chain/test"))

from drawn_arms import drawn_xml, logged

FIRST = 700
"""First seed: none of the tests'."""


METHOD = re.compile(r'integrator="(\w+)"')
"""Where a drawn model says how it is integrated."""


def answers(seed: int, steps: int) -> tuple[str, dict[str, gap.Answer]]:
    """Return the integrator of a healthy arm, and record -> answer: servos at even seeds, motors at odd ones.

    A row of the log is so many steps of the model, in which controls hold.
    """
    xml = drawn_xml(np.random.default_rng(seed), servo=seed % 2 == 0)
    log, model = logged(xml, seed, steps), mujoco.MjModel.from_xml_string(xml)
    force = log.actuator_force * model.actuator_gear[:, 0]
    table, own = {"time": log.time, "qpos": log.qpos}, {"actuator_force": log.actuator_force}
    return METHOD.findall(xml)[0], {
        "ctrl, qpos": gap.diagnose(xml, {**table, "ctrl": log.ctrl}),
        "ctrl, qpos, actuator_force": gap.diagnose(xml, {**table, "ctrl": log.ctrl, **own}),
        "qpos, actuator_force": gap.diagnose(xml, {**table, **own}),
        "arrays of position and effort": gap.diagnose(xml, log.time, None, log.qpos, force),
    }


def main() -> None:
    """Print one line for each log that is not without a gap, and how many are, by record and integrator."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=50)
    parser.add_argument("--steps", type=int, default=1, help="Of the model in a row of the log.")
    args = parser.parse_args()
    count = args.seeds
    drawn: Counter[str] = Counter()
    healthy: Counter[tuple[str, str]] = Counter()
    records: dict[str, None] = {}
    for seed in range(FIRST, FIRST + count):
        method, found = answers(seed, args.steps)
        drawn[method] += 1
        for record, answer in found.items():
            records[record] = None
            healthy[record, method] += answer.status == "no_gap"
            if answer.status != "no_gap":
                print(f"{seed}, {method}, {record}: {answer.headline}", flush=True)
    for record in records:
        each = ", ".join(f"{m} {healthy[record, m]} of {n}" for m, n in sorted(drawn.items()))
        print(f"{record}: no_gap on {sum(healthy[record, m] for m in drawn)} of {count} ({each})", flush=True)


if __name__ == "__main__":
    main()
