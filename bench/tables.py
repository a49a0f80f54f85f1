"""Bench: errors that less than a whole measurement shows, with a zero of its own in each run.

Arms of six joints seen by positions alone and by one length alone, two joint zeros off by 4 to 12 mrad, in two runs
with zeros 2 mm apart; force sensors of six components under known weights with a bias and one gain off by 2 to 8 %, in
two runs with zeros up to 2 N apart; and each without an error. `sher3_static/test` simulates them.

    nice python bench/tables.py --cases 15
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.extend(str(Path(__file__).parents[1] / "sher3_ws/src/sher3_static/test" / x) for x in ("", "arm", "sensor"))
import test_sights
import test_weights


def arm(sight: str, seed: int, healthy: bool):
    """Return a verdict on an arm, and what is to be found: place -> offset, rad."""
    rng = np.random.default_rng(seed)
    off = np.zeros(6)
    joints = rng.choice(np.arange(1, 5), 2, replace=False)  # the ends of the chain look like the set-up
    off[joints] = rng.uniform(4e-3, 12e-3, 2) * rng.choice([-1.0, 1.0], 2) * (not healthy)
    runs = [test_sights.seen(sight, off, zero, 200, seed + k) for k, zero in enumerate((0.0, 2e-3))]
    truth = {f"j{i + 1}": off[i] for i in np.flatnonzero(off)}
    return test_sights.verdict_of(sight, *runs), {("encoder_offset", j, "offset"): x for j, x in truth.items()}


def sensor(seed: int, healthy: bool):
    """Return a verdict on a force sensor, and what is to be found."""
    rng = np.random.default_rng(seed)
    bias = np.r_[rng.uniform(-3.0, 3.0, 3), rng.uniform(-0.1, 0.1, 3)] * (not healthy)
    gain = rng.uniform(0.02, 0.08) * (not healthy)
    again = np.r_[rng.uniform(-1.0, 1.0, 3), np.zeros(3)]
    matrix = np.diag([1.0, 1.0, 1.0 + gain, 1.0, 1.0, 1.0])
    runs = [test_weights.weighed(bias + sign * again, matrix, seed=seed + k) for k, sign in enumerate((1, -1))]
    truth = {("force_bias", "force_sensor", "fz"): bias[2], ("force_scale", "force_sensor", "relative"): gain}
    return test_weights.verdict_of(*runs), {} if healthy else truth


def main() -> None:
    """Print a line for each kind of table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=15, help="of each kind, and as many healthy ones")
    parser.add_argument("--seed", type=int, default=1000, help="of the first case")
    options = parser.parse_args()
    seeds = range(options.seed, options.seed + 10 * options.cases, 10)
    kinds = {
        "positions alone": lambda seed, healthy: arm("positions", seed, healthy),
        "one length alone": lambda seed, healthy: arm("lengths", seed, healthy),
        "known weights": sensor,
    }
    for name, case in kinds.items():
        alarms = sum(case(seed, True)[0].status != "no_gap" for seed in seeds)
        named = wrong = within = numbers = 0
        for seed in seeds:
            verdict, truth = case(seed, False)
            found = {(c.effect, c.actuator) for c in verdict.causes}
            wanted = {(effect, place) for effect, place, _ in truth}
            named, wrong = named + len(found & wanted), wrong + len(found - wanted)
            for cause in verdict.causes:
                for parameter, p in cause.parameters.items():
                    if (value := truth.get((cause.effect, cause.actuator, parameter))) is not None:
                        numbers, within = numbers + 1, within + (p.low <= value <= p.high)
        print(f"{name}: {named} of {2 * options.cases} causes named, {wrong} others; ", end="")
        print(f"{within} of {numbers} intervals hold the truth; {alarms} of {options.cases} healthy alarms", flush=True)


if __name__ == "__main__":
    main()
