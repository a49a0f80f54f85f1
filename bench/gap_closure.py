"""End-to-end closure of every effect: robots of the challenge's own plant, diagnosed, corrected, run again.

`python bench/gap_closure.py [--seed 1000] [--part 0/4] [--json]`. One robot with one fault per effect id, the fault's
own gap 6 to 12 floors. Printed per id: what was found, the gap of the verdict's first place between the robot and the
freely running nominal and corrected simulator, and the same of the tip.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from sher3_challenge.cases.builder import Request, build_case
from sher3_challenge.plants.registry import truth_plant
from sher3_description import load_robot
from sher3_diagnosis.words import quantity, share
from sher3_gap.case.loading import load_case

sys.path.append(str(Path(__file__).parents[1] / "sher3_ws/src/sher3_gap/test"))
from closing import close_loop

GAP = (6.0, 12.0)


def kinds() -> dict[str, str]:
    """Return one kind of fault of the lumped plant per effect id."""
    return {kind.effect: name for name, kind in reversed(truth_plant("lumped").library.items())}


def measure(effect: str, kind: str, seed: int) -> dict[str, Any]:
    """Return the closure of one effect as plain data."""
    with TemporaryDirectory() as scratch:
        truth = build_case(Request(seed, "single", kind, gap=GAP), Path(scratch), load_robot())
        runs, robot = load_case(Path(scratch) / truth["case"])
        found = close_loop(runs, robot)
    causes = [(c.effect, c.actuator) for c in found.verdict.causes]
    row: dict[str, Any] = {"effect": effect, "actuator": truth["effects"][0]["actuator"], "causes": causes}
    row |= {"status": found.verdict.status, "right": any(effect in (c.effect, *c.rivals) for c in found.verdict.causes)}
    for name, gap in (("first", found.first), ("tip", found.tip)):
        row[name] = None if gap is None else {**gap.__dict__, "closure": gap.closure}
    return row


def text(row: dict[str, Any]) -> str:
    """Return one line of the table."""
    mark = "" if row["right"] else " (!)"
    causes = ", ".join(f"{e} {a}" for e, a in row["causes"]) or "-"
    cells = [f"{row['effect']} {row['actuator']}", f"{row['status']}: {causes}{mark}"]
    for part in (row["first"], row["tip"]):
        cells += ["-"] * 3 if part is None else _cells(part)
    return "| " + " | ".join(cells) + " |"


def _cells(part: dict[str, Any]) -> list[str]:
    closure = part["closure"]
    before, after = quantity(part["before"], part["unit"]), quantity(part["after"], part["unit"])
    return [before, after, "-" if closure is None else share(closure)]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--seed", type=int, default=1000)
    parser.add_argument("--part", default="0/1", help="k/n: every n-th effect from the k-th on")
    arguments = parser.parse_args()
    start, step = map(int, arguments.part.split("/"))
    rows = []
    for number, (effect, kind) in enumerate(sorted(kinds().items())):
        if number % step == start:
            rows.append(measure(effect, kind, arguments.seed + number))
            if not arguments.json:
                print(text(rows[-1]), flush=True)
    if arguments.json:
        print(json.dumps({"seed": arguments.seed, "effects": rows}))


if __name__ == "__main__":
    main()
