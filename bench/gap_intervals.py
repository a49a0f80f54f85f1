"""How well the intervals of parameters hold, and how wide they are: sealed cases of the truth plants.

    nice python bench/gap_intervals.py --cases 12
    nice python bench/gap_intervals.py --plant tables --cases 6 --seed 41500

Single faults of 5 to 20 floors, one kind after the other in a random order. Printed are, for every parameter that was
found by name, its error and half width, both relative; then coverage and median half width by plant, and the factor on
all widths that covers 94 % of the other plants' parameters, with what it covers here.
"""

from __future__ import annotations

import argparse
import random
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from sher3_challenge.cases.builder import Request, build_case
from sher3_challenge.plants.registry import plant_names, truth_plant
from sher3_challenge.score.intervals import SYNONYMS
from sher3_common.shares import wilson
from sher3_gap import diagnose_case

GAP = (5.0, 20.0)
COVER = 0.94
"""Share of the parameters that `BEYOND` was set to cover."""
SEEDS = {"lumped": 6500, "tables": 41500, "mujoco": 51500}


class Row(NamedTuple):
    """One parameter: where it came from, and its error and half width over its true value."""

    plant: str
    case: str
    effect: str
    name: str
    error: float
    half: float

    @property
    def inside(self) -> bool:
        """Whether the interval holds the truth."""
        return abs(self.error) <= self.half


def rows_of(plant: str, seed: int, fault: str) -> Iterator[Row]:
    """Build a case, diagnose it, and yield the parameters that were found by name and have an interval."""
    with tempfile.TemporaryDirectory() as scratch:
        truth = build_case(Request(seed, "single", fault, gap=GAP, plant=plant), Path(scratch))
        verdict = diagnose_case(Path(scratch) / truth["case"]).verdict
    effect = truth["effects"][0]
    for cause in verdict.causes:
        stated = {name.lower(): p for name, p in cause.parameters.items()}
        for name, true in effect["parameters"].items() if cause.effect == effect["effect"] else ():
            known = (stated[s] for s in SYNONYMS.get(name, name).split() if s in stated)
            found = next(known, None)
            if found is not None and found.low is not None and found.high is not None and true:
                sign = 1.0 if abs(found.value - true) <= abs(found.value + true) else -1.0
                half = 0.5 * (found.high - found.low) / abs(true)
                yield Row(plant, truth["case"], cause.effect, name, sign * found.value / true - 1.0, half)


def report(rows: list[Row]) -> None:
    """Print coverage and width by plant, and the factor with each plant left out."""
    for plant in (*sorted({r.plant for r in rows}), "all"):
        part = [r for r in rows if plant in (r.plant, "all")]
        hits = sum(r.inside for r in part)
        low, high = wilson(hits / len(part), len(part))
        print(
            f"{plant}: cover {hits / len(part):.2f} [{low:.2f}, {high:.2f}], median half width "
            f"{np.median([r.half for r in part]):.3f}, median error {np.median([abs(r.error) for r in part]):.3f}, "
            f"n {len(part)}"
        )
        others = [abs(r.error) / r.half for r in rows if r.plant != plant and r.half > 0.0]
        if others:
            factor = np.quantile(others, COVER)
            held = np.mean([abs(r.error) <= factor * r.half for r in part])
            print(f"    widths times {factor:.2f} cover {COVER:.0%} of {'the others' if plant != 'all' else 'all'}, "
                  f"{held:.2f} of these")  # fmt: skip


def main() -> None:
    """Print one line per parameter, then the shares."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--plant", choices=plant_names(), help="one of the plants; default all in turn")
    parser.add_argument("--cases", type=int, default=6, help="kinds of faults for each plant")
    parser.add_argument("--skip", type=int, default=0, help="kinds to leave out at the start")
    parser.add_argument("--seed", type=int, help="first seed; default one for each plant")
    asked = parser.parse_args()
    plants = [asked.plant] if asked.plant else list(plant_names())
    kinds = sorted({n for p in plants for n, k in truth_plant(p).library.items() if not k.exact})
    random.Random(3).shuffle(kinds)
    rows: list[Row] = []
    for i, fault in list(enumerate(kinds))[asked.skip : asked.skip + asked.cases]:
        for plant in (p for p in plants if fault in truth_plant(p).library):
            for row in rows_of(plant, (asked.seed or SEEDS[plant]) + i, fault):
                rows.append(row)
                print(
                    f"{row.plant} {row.case} {row.effect} {row.name}: {row.error:+.3f} of ±{row.half:.3f}", flush=True
                )
    if rows:
        report(rows)


if __name__ == "__main__":
    main()
