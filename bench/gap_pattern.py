"""Does a gap live where its cause says? Agreement of true causes and of stand-ins, beside constancy.

`python bench/gap_pattern.py [--seeds 1000:1101] [--json]`. Robots of the challenge with faults, drawn from the
seeds; of those with a single one, a second diagnosis does without the true effect.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from sher3_challenge.cases.builder import Request, build_case
from sher3_description import load_robot
from sher3_diagnosis.attribute.constancy import constancy_of
from sher3_diagnosis.localise.pattern import pattern_of
from sher3_gap.case.loading import load_case
from sher3_gap.sher import diagnose_runs

KINDS = ("single", "single", "compound", "outside")
"""Kinds of the cases, in turn."""
AGREEMENT = 0.9
"""Agreement below which a cause is counted as a stand-in: of 51 true causes of the development seeds 50 have more, of
37 stand-ins 20 have. No verdict depends on it: the agreement itself is an item of the odds."""


def measure(seed: int) -> Iterator[dict[str, Any]]:
    """Yield one row per cause that is named for the case of a seed."""
    with TemporaryDirectory() as scratch:
        truth = build_case(Request(seed, KINDS[seed % len(KINDS)]), Path(scratch), load_robot())
        runs, robot = load_case(Path(scratch) / truth["case"])
    there = {e["effect"] for e in truth["effects"]}
    for without in [(), *([tuple(there)] if truth["kind"] == "single" else [])]:
        found = diagnose_runs(runs, robot, without).findings[0]
        for i, term in enumerate(found.attribution.fit.terms):
            pattern = pattern_of(found.evidence, found.attribution.fit, i)
            constancy = constancy_of(found.evidence, found.attribution.fit, i)
            true = term.effect.id in there and truth["kind"] != "outside"
            yield {"seed": seed, "cause": term.effect.id, "true": true, "without": without} | {
                "agreement": pattern.agreement,
                "spread": constancy.spread,
                "constant": constancy.constant,
            }


def main() -> None:
    """Print how many of each pass."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--seeds", default="1000:1101")
    arguments = parser.parse_args()
    first, last = map(int, arguments.seeds.split(":"))
    rows = [row for seed in range(first, last) for row in measure(seed)]
    if arguments.json:
        print(json.dumps({"seeds": arguments.seeds, "threshold": AGREEMENT, "causes": rows}))
        return
    for name, true in (("true causes", True), ("stand-ins", False)):
        some = [r for r in rows if r["true"] is true]
        agree = [r for r in some if r["agreement"] >= AGREEMENT]
        caught = sum(r["constant"] for r in some if r["agreement"] < AGREEMENT)
        print(f"{name:<12} {len(some):3d}; agree {len(agree):3d}; disagree though constant {caught:3d}")


if __name__ == "__main__":
    main()
