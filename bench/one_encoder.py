"""Bench: which gaps and springs does one encoder show, and what is called one that is none.

Simulated motors with a load behind a gap, on a spring, rigidly coupled, or with a friction that builds up slowly;
masses, frictions, gap and frequency are drawn, each record of 16 s at 500 Hz. `test/two_masses.py` simulates them.

    nice python bench/one_encoder.py --seeds 700:712
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "sher3_ws/src/sher3_chain/test"))
import two_masses

KINDS = ("gap", "spring", "rigid", "slow friction")
NAMED = {"gap": "backlash", "spring": "transmission_compliance"}


def drawn(kind: str, seed: int):
    """Return the rows of a record, its total mass, and what is to be found."""
    rng = np.random.default_rng(seed)
    motor = (rng.uniform(3.0, 8.0), rng.uniform(2.0, 8.0), rng.uniform(0.0, 40.0))
    load = (rng.uniform(3.0, 8.0), rng.uniform(2.0, 8.0))
    noise = float(rng.choice([0.0, 2e-6]))
    if kind == "spring":
        frequency = float(rng.uniform(4.0, 25.0))
        return two_masses.on_spring(frequency, seed, motor, load, rng.uniform(0.02, 0.1)), motor[0] + load[0], frequency
    if kind == "slow friction":
        reach = 10.0 ** rng.uniform(-5.0, -3.5)
        return (
            two_masses.slowly_stuck(reach, seed, motor[0] + load[0], motor[1] + load[1], noise),
            sum((motor[0], load[0])),
            reach,
        )
    gap = 10.0 ** rng.uniform(-4.3, -3.0) if kind == "gap" else 0.0
    return two_masses.behind_gap(gap, seed, motor, load, noise), motor[0] + load[0], gap


def main() -> None:
    """Print a line for each record."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", default="700:706", help="first and end of the seeds, of each kind")
    first, end = map(int, parser.parse_args().seeds.split(":"))
    for seed in range(first, end):
        for kind in KINDS:
            rows, mass, size = drawn(kind, seed)
            verdict = two_masses.verdict_of(rows, mass)
            found = [c for c in verdict.causes if c.effect in NAMED.values()]
            told = [f"{n} {p.value:.3g}" for c in found for n, p in c.parameters.items() if n in ("width", "frequency")]
            right = [c.effect for c in found] == ([NAMED[kind]] if kind in NAMED else [])
            print(f"{seed} {kind:<14} {size:9.3g}  {'right' if right else 'wrong'}  {', '.join(told):<24} ", end="")
            print(f"{verdict.status}; {', '.join(c.effect for c in verdict.causes)}", flush=True)
            limit = [n for n in verdict.notes if "one encoder" in n]
            print(*limit, sep="\n")


if __name__ == "__main__":
    main()
