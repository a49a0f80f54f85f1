"""How well the intervals of parameters hold, and how wide they are: sealed cases of the truth plants.

    nice python bench/gap_intervals.py --cases 12
    nice python bench/gap_intervals.py --plant tables --cases 6 --seed 41500
    nice python bench/gap_intervals.py run/lumped run/tables

Single faults of 5 to 20 floors, one kind after the other in a random order; or those of at least 5 floors in labelled
cases that a challenge kept. Printed are, for every parameter that was found by name, its error, its half width, and the
half width that noise alone would leave (Cramer and Rao), all relative; then a table of coverage and medians by plant,
and of the factor on all widths that covers 94 % of the other plants' parameters, with what it covers here.
"""

from __future__ import annotations

import argparse
import random
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from sher3_challenge.calibration.observe import truth_of
from sher3_challenge.cases.builder import Request, build_case
from sher3_challenge.plants.registry import plant_names, truth_plant
from sher3_challenge.score.intervals import SYNONYMS
from sher3_common.numbers.shares import wilson
from sher3_diagnosis.quantify.parameters import least_widths
from sher3_gap import diagnose_case
from sher3_gap_cli.commands.challenge import plants_of

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
    least: float

    @property
    def inside(self) -> bool:
        """Whether the interval holds the truth."""
        return abs(self.error) <= self.half


def rows_of(plant: str, seed: int, fault: str) -> Iterator[Row]:
    """Build a case, diagnose it, and yield the parameters that were found by name and have an interval."""
    with tempfile.TemporaryDirectory() as scratch:
        truth = build_case(Request(seed, "single", fault, gap=GAP, plant=plant), Path(scratch))
        yield from rows_in(plant, Path(scratch) / truth["case"], truth)


def rows_in(plant: str, case: Path, truth: dict[str, Any]) -> Iterator[Row]:
    """Diagnose a case of a single fault and yield the parameters that were found by name and have an interval."""
    found = diagnose_case(case)
    (effect,), (finding,) = truth["effects"], found.findings
    indices = dict(zip((c.effect for c in finding.causes), finding.attribution.causes, strict=True))
    for cause in found.verdict.causes:
        if cause.effect != effect["effect"] or cause.effect not in indices:
            continue
        stated = {name.lower(): (name, p) for name, p in cause.parameters.items()}
        least = least_widths(finding.evidence, finding.attribution.fit, indices[cause.effect])
        for name, true in effect["parameters"].items():
            own, p = next((stated[s] for s in SYNONYMS.get(name, name).split() if s in stated), ("", None))
            if p is not None and p.low is not None and p.high is not None and true:
                sign = 1.0 if abs(p.value - true) <= abs(p.value + true) else -1.0
                half = 0.5 * (p.high - p.low) / abs(true)
                error = sign * p.value / true - 1.0
                yield Row(plant, truth["case"], cause.effect, name, error, half, least.get(own, 0.0) / abs(true))


def kept(folders: list[str]) -> Iterator[tuple[str, Path, dict[str, Any]]]:
    """Yield plant, folder and label of the single faults of at least `GAP` floors of arguments [PLANT=]FOLDER."""
    for plant, cases in plants_of(folders).items():
        for case in cases:
            truth = truth_of(case)
            gaps = [x["gap_over_floor"] or 0.0 for x in (truth.get("oracle") or {}).values()]
            if truth["status"] == "attributed" and len(truth["effects"]) == 1 and max(gaps, default=0.0) >= GAP[0]:
                yield plant, case, truth


def table(rows: list[Row]) -> str:
    """Return cover and width by plant as a table of the page `interval-figures.md`."""
    plants = sorted({r.plant for r in rows})
    parts = [[r for r in rows if r.plant == p] for p in plants] + [rows]
    others = [[r for r in rows if r.plant != p] for p in plants] + [rows]
    factors = [np.quantile([abs(r.error) / r.half for r in x if r.half > 0.0] or [np.nan], COVER) for x in others]
    left_out = [np.mean([abs(r.error) <= f * r.half for r in x]) for f, x in zip(factors, parts, strict=True)]
    lines = {
        "number": [str(len(x)) for x in parts],
        "hold the truth": [held(x) for x in parts],
        "median half width": [f"{100.0 * np.median([r.half for r in x]):.1f} %" for x in parts],
        "by noise alone": [f"{100.0 * np.median([r.least for r in x]):.1f} %" for x in parts],
        "median error": [f"{100.0 * np.median([abs(r.error) for r in x]):.1f} %" for x in parts],
    }
    if len(plants) > 1:
        lines |= {
            f"all widths times, so that {100.0 * COVER:.0f} % of the others hold it": [f"{x:.2f}" for x in factors],
            "then hold the truth": [f"{x:.2f}" for x in left_out],
        }
    head = ["parameters", *plants, "together"]
    cells = [head, ["---"] * len(head), *([name, *row] for name, row in lines.items())]
    return "\n".join(f"| {' | '.join(row)} |" for row in cells)


def held(rows: list[Row]) -> str:
    """Return the share of intervals that hold the truth, with its Wilson interval."""
    hits = sum(r.inside for r in rows)
    low, high = wilson(hits / len(rows), len(rows))
    return f"{hits / len(rows):.2f} [{low:.2f}, {high:.2f}]"


def main() -> None:
    """Print one line per parameter, then the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="*", metavar="[PLANT=]FOLDER", help="labelled cases; default new ones")
    parser.add_argument("--plant", choices=plant_names(), help="one of the plants; default all in turn")
    parser.add_argument("--cases", type=int, default=6, help="kinds of faults for each plant")
    parser.add_argument("--skip", type=int, default=0, help="kinds to leave out at the start")
    parser.add_argument("--seed", type=int, help="first seed; default one for each plant")
    asked = parser.parse_args()
    plants = [asked.plant] if asked.plant else list(plant_names())
    kinds = sorted({n for p in plants for n, k in truth_plant(p).library.items() if not k.exact})
    random.Random(3).shuffle(kinds)
    chosen = list(enumerate(kinds))[asked.skip : asked.skip + asked.cases]
    built = (
        rows_of(plant, (asked.seed or SEEDS[plant]) + i, fault)
        for i, fault in chosen
        for plant in plants
        if fault in truth_plant(plant).library
    )
    rows: list[Row] = []
    for found in (rows_in(*case) for case in kept(asked.folders)) if asked.folders else built:
        for row in found:
            rows.append(row)
            text = f"{row.error:+.3f} of ±{row.half:.3f}, ±{row.least:.3f} by noise alone"
            print(f"{row.plant} {row.case} {row.effect} {row.name}: {text}", flush=True)
    if rows:
        print(table(rows))


if __name__ == "__main__":
    main()
