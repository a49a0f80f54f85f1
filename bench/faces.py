"""How long the faces take: importing a small name, and the help pages of the command.

    python bench/faces.py [--json]

Each line runs in a process of its own, three times, and shows the best. The times include the start of Python, which
is printed too; the targets are those of an interactive command on a computer of two cores.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time

RUNS = 3
HELP_TARGET, NAME_TARGET = 0.7, 0.5
"""Seconds for a help page and for importing a small name."""

NAMES = [
    "from sher3_common import Sher3Error",
    "from sher3_description import ACTUATORS",
    "from sher3_bags import BagError",
    "from sher3_faults import KINDS",
    "from sher3_safety import Row",
    "from sher3_bringup import ConfigurationError",
    "from sher3_benchtop import Timeline",
]
PAGES = ["", "gap", "up", "safety", "benchtop", "paper", "record", "fk"]


def seconds(command: list[str]) -> float:
    """Return the best time of a command [s]."""
    times = []
    for _ in range(RUNS):
        start = time.perf_counter()
        subprocess.run(command, check=True, capture_output=True)
        times.append(time.perf_counter() - start)
    return min(times)


def main() -> None:
    """Print the times beside their targets."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    python = [sys.executable, "-c"]
    rows = [("start of Python", seconds([*python, "pass"]), None)]
    rows += [(name, seconds([*python, name]), NAME_TARGET) for name in NAMES]
    for page in PAGES:
        words = [*page.split(), "--help"]
        rows.append((" ".join(["sher3", *words]), seconds([sys.executable, "-m", "sher3_cli", *words]), HELP_TARGET))
    if options.json:
        print(json.dumps([{"what": what, "seconds": taken, "target": target} for what, taken, target in rows]))
        return
    for what, taken, target in rows:
        missed = target is not None and taken > target
        goal = "" if target is None else f"target {target:.1f} s" + ("  MISSED" if missed else "")
        print(f"{what:46s} {taken:5.2f} s  {goal}")


if __name__ == "__main__":
    main()
