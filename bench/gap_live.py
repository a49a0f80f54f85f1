"""The live monitor beside a healthy robot: how often it names a gap that is none.

    nice python bench/gap_live.py --minutes 60

Healthy sweeps of the simulated robot, each with noise of its own, are fed to the monitor sample by sample in stepped
time; it judges once a second, and whatever it names is a false alarm.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "sher3_ws" / "src" / "sher3_gap" / "test"))

from test_naming import watched

PART = 13
"""Sweeps of one simulated run: a minute."""


def main() -> None:
    """Print seconds of motion and false alarms."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    asked = parser.parse_args()
    seconds, alarms, seed = 0, 0, asked.first
    while seconds < 60.0 * asked.minutes:
        told = watched([], PART, seed)
        seconds, alarms, seed = seconds + len(told), alarms + sum(named is not None for named in told), seed + 1
        print(f"{seconds} s of healthy motion, {alarms} of them with a name", flush=True)


if __name__ == "__main__":
    main()
