"""How often the 95 % interval of an identified link or rotor holds the true number, on drawn arms of MuJoCo.

Every link and rotor is off from its model, and the last joint has 0.8 N m of dry friction besides.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
import sher3.gap as gap

sys.path.append(str(Path(__file__).parents[1] / "sher3_ws/src/sher3_chain/test"))

from drawn_arms import beyond, log_of_servos, rough

FIRST, SECONDS = 100, 8.0
"""First seed: none of the tests'; length of a log, s."""


def held(seed: int, joints: int) -> list[bool]:
    """Return whether each interval of an arm holds the truth."""
    rng = np.random.default_rng(seed)
    xml, spec = rough(rng, joints)
    answer = gap.diagnose(xml, log_of_servos(spec.compile(), rng, SECONDS), inertias="identified")
    truth = beyond(xml, spec)
    each = [(x.actuator, name, p) for x in answer.verdict.identified for name, p in x.constants.items()]
    return [p.low <= truth[at, name] <= p.high for at, name, p in each if p.low is not None and p.high is not None]


def main() -> None:
    """Print the share of intervals that hold the truth, by number of joints."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=20)
    count = parser.parse_args().seeds
    for joints in (2, 3, 4):
        found = [x for seed in range(FIRST, FIRST + count) for x in held(seed, joints)]
        print(f"{joints} joints: {sum(found)} of {len(found)} intervals hold the truth on {count} arms", flush=True)


if __name__ == "__main__":
    main()
