"""Bench: whether one more experiment settles what a verdict leaves at odds between 10 and 90 %.

    nice python bench/settle.py EVIDENCE --most 20      # EVIDENCE: folder of `sher3 gap calibrate --drawn --kept`

For every drawn case of which a cause has such odds, the same robot is simulated again with the runs it had and with the
excitation that shows the cause best, twice in each of two postures that the case had not used. Printed are the odds of
the library before and after, whether they are settled then (95 % one way) and right, and both shares with their
intervals; beside it the mean of the more probable answer's odds, which is how often it should be right.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from sher3_challenge.calibration.drawn import plan_of
from sher3_challenge.calibration.held_out import item_of
from sher3_challenge.calibration.labels import answer_of
from sher3_challenge.calibration.observe import Observation, observed_on, stored
from sher3_challenge.cases.plan import RUN_SPACING_NS, CasePlan
from sher3_challenge.plants.plant import RunPlan
from sher3_common.numbers.shares import wilson
from sher3_description import Robot, load_robot
from sher3_diagnosis.finding import LIBRARY
from sher3_diagnosis.judge.calibration.calibration import in_force
from sher3_diagnosis.judge.probabilities import judged
from sher3_effects import library
from sher3_gap.case.loading import signals_of
from sher3_gap.excitation import POSTURES, excite
from sher3_gap.sher import Sher

OPEN, SETTLED = (0.10, 0.90), 0.95
MORE, REPEATS = 2, 2
"""Postures that are added, and runs in each."""


def odds_of(row: dict) -> float:
    """Return the probability that a kept cause is the library's."""
    return judged(item_of(row), in_force()).library


def doubts(folder: Path) -> Iterator[tuple[Observation, Observation, dict]]:
    """Yield observations with that of the whole library and their cause whose odds are open; the first of each case."""
    for file in sorted(folder.rglob("drawn_*.json")):
        rows = stored(file)
        for seen in rows:
            causes = [x for x in seen.items if x["index"] is not None and answer_of(seen, x, rows[0]) is not None]
            open_ = [x for x in causes if OPEN[0] < odds_of(x) < OPEN[1]]
            if open_:
                yield seen, rows[0], open_[0]
                break


def further(plan: CasePlan, effect: str, robot: Robot) -> tuple[RunPlan, ...]:
    """Return the runs of a plan and those of the excitation that shows an effect best, in other postures."""
    label, last = library()[effect].best.excitation, plan.runs[-1].stamp
    used = {tuple(r.excitation.position[0]) for r in plan.runs}
    fresh = [e for p in POSTURES if tuple((e := excite(label, robot, posture=p)).position[0]) not in used][:MORE]
    new = [(e, k) for e in fresh for k in range(REPEATS)]
    extra = [RunPlan(e, k, last + (n + 1) * RUN_SPACING_NS, plan.seed + 7 * n + 1) for n, (e, k) in enumerate(new)]
    return (*plan.runs, *extra)


def again(seen: Observation, effect: str, robot: Robot) -> list[Observation]:
    """Return the observation of the same robot with more runs."""
    seed = int(seen.case.split("_")[1])
    kind = seen.truth["kind"] if seen.truth["kind"] != "withheld" else "single"
    plan, _ = plan_of(robot, seen.plant, kind, seed)
    plan = replace(plan, runs=further(plan, effect, robot))
    made, first = plan.plant(robot), min(r.stamp for r in plan.runs)
    runs = [
        replace(signals_of(made.run(p), robot, f"run {i}"), session_time=(p.stamp - first) * 1e-9)
        for i, p in enumerate(plan.runs)
    ]
    libraries = [(), seen.without] if seen.without else [()]
    return observed_on(Sher(robot), seen.plant, seen.case, seen.truth, runs, libraries)


def main() -> None:
    """Print a line for each case, and the shares."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--most", type=int, default=40, help="cases")
    parser.add_argument("--seconds", type=float, default=480.0, help="of the processor, at which no case is begun")
    options = parser.parse_args()
    robot, found = load_robot(), []
    for seen, whole, row in list(doubts(options.folder))[: options.most]:
        if time.process_time() > options.seconds:
            break
        effect, site = row["candidates"][0]["effect"], row["candidates"][0]["site"]
        rows = again(seen, effect, robot)
        right = answer_of(seen, row, whole) == LIBRARY
        same = [
            x for x in rows[-1].items if x["index"] is not None and x["channel"] == row["channel"]
            and (x["candidates"][0]["effect"], x["candidates"][0]["site"]) == (effect, site)
        ]  # fmt: skip
        before, after = odds_of(row), odds_of(same[0]) if same else 0.0
        found.append((before, after, right))
        gone = "" if same else " (another cause is named)"
        print(f"{seen.plant} {seen.case}{' without' if seen.without else ''}: {effect} on {site}, "
              f"{'right' if right else 'wrong'}: {before:.2f} -> {after:.2f}{gone}", flush=True)  # fmt: skip
    settled = [(p, right) for _, p, right in found if max(p, 1.0 - p) >= SETTLED]
    good = sum((p >= 0.5) == right for p, right in settled)
    for name, k, n in (("settled", len(settled), len(found)), ("of these right", good, len(settled))):
        if n:
            low, high = wilson(k / n, n)
            print(f"{name}: {k} of {n}, {k / n:.2f} [{low:.2f}, {high:.2f}]")
    if found:
        print(f"more probable answer: {sum(max(p, 1 - p) for p, _, _ in found) / len(found):.2f} before, "
              f"{sum(max(p, 1 - p) for _, p, _ in found) / len(found):.2f} after")  # fmt: skip


if __name__ == "__main__":
    main()
