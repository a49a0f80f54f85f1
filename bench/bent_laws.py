"""Bench: what it changes that a bend of a right law is expected, and that the causes of a gap share what they leave.

    python bench/bent_laws.py EVIDENCE      # folder of `sher3 gap calibrate --drawn --kept`, seconds
    nice python bench/bent_laws.py EVIDENCE --draw 120000:120100 --seconds 900      # draws cases of bent laws first

Printed is the table of all cases, of robots with bent and with close laws, and of each plant, by the weights in force:
once with all that is left of a gap held against its cause (`all left`), once as if each cause stood alone, and once as
it is judged: less what is a bend of its law, beside the other causes of its gap; with the log loss of the causes' odds.
Then the same of gaps of one to three floors alone, and what other costs make of these odds: right causes called outside
against foreign and withheld effects blamed.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from pathlib import Path

from other_odds import causes_of, surprise
from sher3_challenge.calibration.drawn import draw
from sher3_challenge.calibration.held_out import by_plant, by_shape, groups, judged_by, middle
from sher3_challenge.calibration.observe import Observation, stored, without_evidence
from sher3_challenge.calibration.table import rates, small, written
from sher3_challenge.plants.level import SHAPE, Level
from sher3_challenge.score.rates import Rate
from sher3_diagnosis.judge.calibration.calibration import in_force
from sher3_diagnosis.judge.costs import Costs

PLANTS = ("lumped", "tables", "mujoco")
NAMING = (0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0)
"""Costs of a wrong name, of which an abstention costs one."""
MISTAKES = ("rightly named, called outside", "outside blamed", "withheld blamed")


def draw_bent(seeds: range, kept: Path, seconds: float) -> None:
    """Keep the evidence of robots whose laws are bent, of the seeds that draw such; none is begun after `seconds`."""
    bent = [seed for seed in seeds if Level.drawn(seed).shape >= middle(SHAPE)]
    for rows in draw(PLANTS, bent, kept):
        print(rows[0].plant, rows[0].case, flush=True)
        if time.process_time() > seconds:
            return


def over_costs(seen: Sequence[Observation]) -> str:
    """Return the table in Markdown of the mistakes that the odds of cases make at other costs of a wrong name."""
    lines = [f"| a wrong name costs | {' | '.join(MISTAKES)} |", "|---" * (len(MISTAKES) + 1) + "|"]
    for name in NAMING:
        found = rates(judged_by(in_force(), seen, Costs(name=name)))
        lines.append(f"| {name:g} | {' | '.join(_counted(found[m]) for m in MISTAKES)} |")
    return "\n".join(lines)


def _counted(rate: Rate) -> str:
    if rate.value is None:
        return "-"
    return f"{rate.value * rate.n:.0f} of {rate.n} [{rate.low:.2f}, {rate.high:.2f}]"


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
    few = small(judged_by(in_force(), found))
    print(f"gaps of one to three floors\n{written({'all': rates(few, small)})}\n")
    for name, seen in {"all": found, **groups(found, by_shape)}.items():
        print(f"{name}, other costs\n{over_costs(seen)}\n")


if __name__ == "__main__":
    main()
