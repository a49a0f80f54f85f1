"""Seconds of a diagnosis: a case of ten 8 s runs, and what one more effect, run or actuator costs.

`nine runs of one core` is the processor time of a nine-run case, and `command` that of `sher3 gap diagnose` for it with
its start and its report: times that other work on the machine lengthens little.

`python bench/gap.py [--json]`. The robot of the case rubs on one axis, which most of the search is spent on. Numba has
compiled before the clock starts.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from sher3_bags import write_case
from sher3_description import load_robot
from sher3_effects import library, plants
from sher3_gap import diagnose_case
from sher3_gap.excitation import excite
from sher3_gap.experiments.rehearsal import rehearse
from sher3_sim import PlantEffect, RunScatter

ROBOT = load_robot()
LABELS = ("sweep", "sweep", "reversals", "reversals", "steps", "steps", "postures", "loads", "task", "task")
SECONDS = 8.0
RUBBING = ("delta_2", "tilt", "delta_1")
LEFT_OUT = ("cogging", "position_friction", "stribeck_friction", "cable_drag")


def make_case(folder: Path, runs: int, effects: Sequence[PlantEffect]) -> Path:
    """Write a case of `runs` runs of `SECONDS` each."""
    counted: dict[str, int] = {}
    wanted = []
    for label in LABELS[:runs]:
        wanted.append((excite(label, ROBOT, duration=SECONDS), counted.setdefault(label, 0)))
        counted[label] += 1
    return write_case(folder, rehearse(ROBOT, wanted, effects, scatter=RunScatter(zero=0.05)), ROBOT)


def seconds(case: Path, without: Sequence[str] = ()) -> float:
    """Return the wall-clock seconds from the folder to the verdict."""
    started = time.perf_counter()
    diagnose_case(case, without=without)
    return time.perf_counter() - started


def processor_seconds(case: Path) -> float:
    """Return the processor seconds from the folder to the verdict."""
    started = time.process_time()
    diagnose_case(case)
    return time.process_time() - started


def command_seconds(case: Path) -> float:
    """Return the processor seconds, in its own code, of the command that diagnoses a case and writes the report."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    command = [sys.executable, "-m", "sher3_cli", "gap", "diagnose", str(case), "--out", str(case / "answer")]
    subprocess.run(command, check=True, capture_output=True)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def measure() -> dict[str, float]:
    """Return the figures, seconds each."""
    friction = [plants()["coulomb_friction"](a, force=1.0) for a in RUBBING]
    with TemporaryDirectory() as scratch:
        folder = Path(scratch)
        whole = make_case(folder / "ten", 10, friction[:1])
        nine, short = (make_case(folder / str(n), n, friction[:1]) for n in (9, 6))
        healthy = make_case(folder / "healthy", 10, [])
        several = make_case(folder / "several", 10, friction)
        seconds(short)
        ten, six = seconds(whole), seconds(short)
        fewer = seconds(whole, LEFT_OUT)
        return {
            "ten_runs_of_8_s": ten,
            "nine_runs_of_one_core": processor_seconds(nine),
            "command": command_seconds(nine),
            "healthy": seconds(healthy),
            "per_effect": (ten - fewer) / len(LEFT_OUT),
            "per_run": (ten - six) / 4,
            "per_faulty_actuator": (seconds(several) - ten) / (len(RUBBING) - 1),
            "effects": float(len(library())),
        }


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    figures = measure()
    if parser.parse_args().json:
        print(json.dumps(figures))
        return
    for name, value in figures.items():
        print(f"{name.replace('_', ' '):<22} {value:7.2f}" + ("" if name == "effects" else " s"))


if __name__ == "__main__":
    main()
