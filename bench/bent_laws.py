"""Bench: what it changes that a bend of a right law is expected, and that the causes of a gap share what they leave.

    python bench/bent_laws.py EVIDENCE      # folder of `sher3 gap calibrate --drawn --kept`, seconds
    nice python bench/bent_laws.py EVIDENCE --draw 120000:120100 --seconds 900      # draws cases of bent laws first

Printed is the table of all cases, of robots with bent and with close laws, and of each plant, by the weights in force:
once with all that is left of a gap held against its cause (`all left`), once as if each cause stood alone, and once as
it is judged: less what is a bend of its law, beside the other causes of its gap; then log loss of the causes' odds, and
how well what is left, less a bend or not, tells right causes from foreign ones (area under the curve), on the causes
that leave between 2 and 20 %.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from other_odds import causes_of, surprise
from sher3_challenge.calibration.drawn import draw
from sher3_challenge.calibration.held_out import by_plant, by_shape, groups, judged_by, middle
from sher3_challenge.calibration.labels import answer_of
from sher3_challenge.calibration.observe import stored, without_evidence
from sher3_challenge.calibration.table import rates, written
from sher3_challenge.plants.level import SHAPE, Level
from sher3_diagnosis.finding import LIBRARY, OUTSIDE
from sher3_diagnosis.judge.calibration.calibration import in_force
from sher3_diagnosis.judge.evidence.scales import strange

DOUBTFUL = (0.02, 0.20)
"""Shares left of which both right and foreign causes are known."""


def area(right: Sequence[float], foreign: Sequence[float]) -> float:
    """Return the share of pairs of a right and a foreign cause of which the right one has less."""
    return float(np.mean([(r < f) + 0.5 * (r == f) for r in right for f in foreign]))


PLANTS = ("lumped", "tables", "mujoco")


def draw_bent(seeds: range, kept: Path, seconds: float) -> None:
    """Keep the evidence of robots whose laws are bent, of the seeds that draw such; none is begun after `seconds`."""
    bent = [seed for seed in seeds if Level.drawn(seed).shape >= middle(SHAPE)]
    for rows in draw(PLANTS, bent, kept):
        print(rows[0].plant, rows[0].case, flush=True)
        if time.process_time() > seconds:
            return


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--draw", help="A:B, seeds of robots of which those with bent laws are drawn")
    parser.add_argument("--seconds", type=float, default=900.0, help="of the processor, after which none is drawn")
    options = parser.parse_args()
    if options.draw:
        first, last = map(int, options.draw.split(":"))
        draw_bent(range(first, last), options.folder, options.seconds)
    found = [o for file in sorted(options.folder.rglob("*.json")) for o in stored(file)]
    alike = {
        "all left": [without_evidence(o, "stray") for o in found],
        "each cause alone": [without_evidence(o, "part") for o in found],
        "in force": found,
    }
    for name, seen in alike.items():
        own = {"all": seen, **groups(seen, by_shape), **groups(seen, by_plant)}
        judged = {group: judged_by(in_force(), rows) for group, rows in own.items()}
        print(f"{name}: {surprise(causes_of(judged['all']))}")
        print(written({group: rates(j) for group, j in judged.items()}) + "\n")
    whole = {(o.plant, o.case): o for o in found if not o.without}
    causes = [
        (x["numbers"], answer_of(o, x, whole[o.plant, o.case]))
        for o in found
        for x in o.items
        if x["index"] is not None
    ]
    near = [(n, a) for n, a in causes if DOUBTFUL[0] < n["left"] < DOUBTFUL[1]]
    right, foreign = ([n for n, a in near if a == answer] for answer in (LIBRARY, OUTSIDE))
    if right and foreign:
        told = area([n["left"] for n in right], [n["left"] for n in foreign])
        better = area(*([strange(n) for n in some] for some in (right, foreign)))
        print(
            f"area under the curve: left {told:.2f}, strange {better:.2f} ({len(right)} right, {len(foreign)} foreign)"
        )


if __name__ == "__main__":
    main()
