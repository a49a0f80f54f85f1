"""How often a healthy arm of MuJoCo is called one without a gap: drawn models, servos and motors in turn."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
import sher3.gap as gap

sys.path.append(str(Path(__file__).parents[1] / "sher3_ws/src/sher3_chain/test"))

from drawn_arms import drawn_xml, logged

FIRST = 700
"""First seed: none of the tests'."""


def answered(seed: int, measured: bool) -> gap.Answer:
    """Return the answer on a healthy log: servos at even seeds, motors at odd ones."""
    xml = drawn_xml(np.random.default_rng(seed), servo=seed % 2 == 0)
    log = logged(xml, seed)
    table = {"time": log.time, "ctrl": log.ctrl, "qpos": log.qpos}
    return gap.diagnose(xml, {**table, "actuator_force": log.actuator_force} if measured else table)


def main() -> None:
    """Print one line for each log that is not without a gap, and the share of those that are."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=50)
    count = parser.parse_args().seeds
    for measured in (False, True):
        healthy = 0
        for seed in range(FIRST, FIRST + count):
            found = answered(seed, measured)
            healthy += found.status == "no_gap"
            if found.status != "no_gap":
                print(f"{seed}: {found.headline}", flush=True)
        columns = "ctrl, qpos, actuator_force" if measured else "ctrl, qpos"
        print(f"{columns}: no_gap on {healthy} of {count}", flush=True)


if __name__ == "__main__":
    main()
