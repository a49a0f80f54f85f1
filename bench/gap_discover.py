"""Discovery on sealed cases: each effect of the library left out in turn, and the foreign ones.

    nice python bench/gap_discover.py --seeds 20000:20100 --plant lumped
    nice python bench/gap_discover.py --seeds 21000:21040 --kinds healthy
    nice python bench/gap_discover.py --seeds 101000:101006 --plant lumped --faults demand_slew,stale_feedback
    nice python bench/gap_discover.py --cases labelled_cases

A case is built from a truth plant, diagnosed without its effect, and a formula is looked for where the verdict leaves
the gap unexplained; where the verdict blames a relative, at the first place. Printed are, with Wilson intervals, the
share of cases whose held-out closure is at least 0.8 of the oracle's, and within 0.9 of the ceiling's.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from sher3_challenge.cases.builder import Request, build_case, withhold
from sher3_challenge.plants.registry import plant_names, truth_plant
from sher3_common import read_yaml
from sher3_common.numbers.shares import wilson
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.discover.discover import discover
from sher3_diagnosis.discover.feature import FormulaError
from sher3_gap import diagnose_case

OF_ORACLE, OF_CEILING = 0.8, 0.9
"""Shares of the oracle's and of the ceiling's closure that count as reached."""


def labelled(folder: Path) -> Iterator[tuple[dict[str, Any], Path]]:
    """Return truth and path of every labelled case that a formula can be asked for: single, foreign or healthy."""
    for file in sorted(folder.glob("*/truth.yaml")):
        truth = read_yaml(file)
        if len(truth["effects"]) <= 1 and truth["status"] != "under_excited":
            yield truth if truth["status"] != "attributed" else withhold(truth), file.parent


def built(requests: Iterable[Request]) -> Iterator[tuple[dict[str, Any], Path]]:
    """Build one case after the other."""
    for request in requests:
        with tempfile.TemporaryDirectory() as scratch:
            truth = build_case(request, Path(scratch))
            yield truth, Path(scratch) / truth["case"]


def answered(truth: dict[str, Any], case: Path) -> dict[str, Any]:
    """Diagnose one case without its effect and look for a formula; return what there is to count."""
    started = time.process_time()
    diagnosis = diagnose_case(case, without=truth.get("without", ()))
    verdict = diagnosis.verdict
    able = [o for o in truth["oracle"].values() if o["closure"] is not None]
    best = max(able, key=lambda o: o["gap_over_floor"] or 0.0, default=None)
    row: dict[str, Any] = {
        "case": truth["case"], "fault": "+".join(e.get("fault", e["effect"]) for e in truth["effects"]) or "-",
        "stage": truth["effects"][0]["stage"] if truth["effects"] else "-", "status": verdict.status,
        "oracle": None if best is None else best["closure"],
        "gap_over_floor": None if best is None else best["gap_over_floor"],
    }  # fmt: skip
    place = verdict.unexplained or (verdict.where[0] if verdict.where else None)
    if place is not None:
        try:
            found = discover(diagnosis, Channel(place.stage, place.actuator))
        except FormulaError as error:
            return row | {"place": f"{place.stage}/{place.actuator}", "note": error.what}
        row |= {
            "place": str(found.channel), "note": found.note, "terms": [str(t.feature) for t in found.terms],
            "closure": found.closure.value if found.closure else None,
            "ceiling": found.ceiling.value if found.ceiling else None,
        }  # fmt: skip
    return row | {"seconds": round(time.process_time() - started, 1)}


def told(name: str, hits: int, n: int) -> str:
    """Return a share with its Wilson interval."""
    if n == 0:
        return f"{name}: no case"
    low, high = wilson(hits / n, n)
    return f"{name}: {hits / n:.2f} ({low:.2f} … {high:.2f}), n {n}"


def main() -> None:
    """Print one line of JSON per case, then the shares."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", default="20000:20040")
    parser.add_argument("--kinds", default="withheld,outside")
    parser.add_argument("--plant", default="lumped", choices=plant_names())
    parser.add_argument("--gap", default="3:30", help="gap over floor")
    parser.add_argument("--cases", type=Path, help="folder of labelled cases in place of seeds")
    parser.add_argument("--only", default="", help="names of faults, parted by commas: the others are left out")
    parser.add_argument("--faults", default="", help="names of faults, parted by commas, dealt in turn")
    asked = parser.parse_args()
    first, last = map(int, asked.seeds.split(":"))
    low, high = map(float, asked.gap.split(":"))
    kinds = asked.kinds.split(",")
    faults, outside = [f or None for f in asked.faults.split(",")], set(truth_plant(asked.plant).outside)
    requests = (
        Request(seed, {"withheld": "single"}.get(kind, kind), fault, kind == "withheld", (low, high), plant=asked.plant)
        for n, seed in enumerate(range(first, last))
        for fault in (faults[n % len(faults)],)
        for kind in (kinds[n % len(kinds)] if fault is None else "outside" if fault in outside else "withheld",)
    )
    rows = []
    for truth, case in labelled(asked.cases) if asked.cases else built(requests):
        names = {e.get("fault", e["effect"]) for e in truth["effects"]}
        if asked.only and not names & set(asked.only.split(",")):
            continue
        rows.append(answered(truth, case))
        print(json.dumps(rows[-1]), flush=True)
    report(rows)


def report(rows: list[dict[str, Any]]) -> None:
    """Print the shares over all cases, and over those at a stage with a measured residual."""
    claimed = [r for r in rows if r.get("closure") is not None]
    healthy = [r for r in rows if r["fault"] == "-"]
    print(told("healthy: a formula claimed", sum(r in claimed for r in healthy), len(healthy)))
    measured = [r for r in rows if r["stage"] not in ("transport", "controller")]
    for name, part in (("all", rows), ("without exact stages", measured)):
        able = [r for r in part if r["oracle"]]
        good = [r for r in able if (r.get("closure") or 0.0) >= OF_ORACLE * r["oracle"]]
        print(told(f"{name}: closure of at least {OF_ORACLE} of the oracle's", len(good), len(able)))
        known = [r for r in able if r.get("ceiling") is not None]
        near = [r for r in known if (r.get("closure") or 0.0) >= OF_CEILING * r["ceiling"]]
        print(told(f"{name}: at least {OF_CEILING} of the ceiling", len(near), len(known)))


if __name__ == "__main__":
    main()
