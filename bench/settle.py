"""Bench: whether the experiment that a verdict names settles its odds, and whether it promised as much.

    nice python bench/settle.py --seeds 150000:150040      # robots that move too little to tell rivals apart

Every robot is drawn, simulated and diagnosed. Where the best bet of the first place has odds between 10 and 90 % and
the verdict foretells what an experiment makes of them, the same robot runs this experiment, and the case with all of
its runs is diagnosed again; where that does not settle it (`SURE`), what the new verdict names follows. A tracker that
was added stays. Rivals of which the verdict says that nothing tells them apart are one answer. Printed are the odds of
that bet before, as expected, and of the likeliest answer after each experiment, and the shares with their intervals.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeGuard

import numpy as np
from sher3_challenge.calibration.drawn import plan_of
from sher3_challenge.calibration.labels import equal
from sher3_challenge.calibration.table import SURE
from sher3_challenge.cases.plan import RUN_SPACING_NS, CasePlan
from sher3_challenge.plants.plant import RunPlan
from sher3_common.numbers.shares import wilson
from sher3_description import Robot, load_robot
from sher3_diagnosis.verdict import Answer, NextExperiment, Place, Verdict
from sher3_gap.case.loading import signals_of
from sher3_gap.excitation import excite
from sher3_gap.experiments.foreseen import APART, REPEATS, SAME, TRACKED, WARMED, WARMER
from sher3_gap.sher import diagnose_runs

PLANTS = ("lumped", "tables", "mujoco")
OPEN = (0.10, 0.90)
MOST = 3
"""Experiments that are made one after the other, each the one that the last verdict names."""


@dataclass(frozen=True)
class Settled:
    """What became of an open place.

    Attributes:
        before: odds of its best bet.
        expected: odds of the effect at work, after the experiment that the verdict names.
        reached: those that it then has.
        after: odds of the likeliest answer after each experiment, and whether it is right.
    """

    before: float
    expected: float
    reached: float
    after: tuple[tuple[float, bool], ...]

    def by(self, experiments: int) -> tuple[float, bool]:
        """Return the answer after so many experiments, or after the last one made."""
        return self.after[:experiments][-1]


def signals(plan: CasePlan, runs: Sequence[RunPlan], robot: Robot) -> list[Any]:
    """Return the signals of a robot's runs."""
    made, first = plan.plant(robot), min(r.stamp for r in plan.runs)
    return [
        replace(signals_of(made.run(p), robot, f"run at {p.stamp}"), session_time=(p.stamp - first) * 1e-9)
        for p in runs
    ]


def run_again(plan: CasePlan, asked: NextExperiment, taken: int, robot: Robot) -> list[Any]:
    """Return the signals of an experiment that follows `taken` runs, with what it adds; no repeats of what there is."""
    climate = replace(plan.climate, start=plan.climate.start + WARMER * (asked.added == WARMED))
    other = replace(plan, climate=climate)
    if asked.excitation == SAME:
        recorded = {run.excitation.label: run.excitation for run in plan.runs}
        new = [(replace(e, name=f"{e.name}_again"), 0) for e in recorded.values()]
    else:
        apart = [(excite(asked.excitation, robot, posture=p), f"{asked.excitation}_in_{p}") for p in APART]
        new = [(replace(e, name=name), k) for e, name in apart for k in range(REPEATS)]
    first = min(r.stamp for r in plan.runs)
    runs = [
        RunPlan(e, k, first + (taken + n) * RUN_SPACING_NS, plan.seed + 7 * (taken + n)) for n, (e, k) in enumerate(new)
    ]
    return signals(other, runs, robot)


def is_right(answer: Answer, plan: CasePlan) -> bool:
    """Whether an answer holds nothing but true effects."""
    true = {f.kind.effect for f in plan.faults}
    return bool(answer.causes) and all(equal(c.effect, true) for c in answer.causes)


def named(answer: Answer) -> str:
    """Return the effects of an answer, or what it is."""
    return " + ".join(c.effect for c in answer.causes) or str(answer.answer)


def foretold(asked: NextExperiment | None) -> TypeGuard[NextExperiment]:
    """Whether an experiment is named, and what it would make of the odds."""
    return asked is not None and asked.expected_odds is not None


def same_place(verdict: Verdict, before: Place) -> Place | None:
    """Return the place that an earlier verdict had."""
    return next((p for p in verdict.places if (p.stage, p.actuator) == (before.stage, before.actuator)), None)


def settled(seed: int, kind: str, robot: Robot) -> Settled | None:
    """Draw a case, run what its verdicts name until its first place is settled, and say what became of it."""
    plan, _ = plan_of(robot, PLANTS[seed % 3], kind, seed)
    runs = signals(plan, plan.runs, robot)
    verdict = diagnose_runs(runs, robot).verdict
    place = next(iter(verdict.places), None)
    bet, asked = None if place is None else place.bet, verdict.next_experiment
    if place is None or bet is None or not foretold(asked) or not OPEN[0] < bet.probability < OPEN[1]:
        print(f"{plan.truth.name} {seed}: no open bet", flush=True)
        return None
    expected, reached, after = asked.expected_odds, [], []
    true = " + ".join(f.kind.effect for f in plan.faults)
    said = f"{plan.truth.name} {seed}: {true}; {named(bet)} {bet.probability:.2f}"
    while foretold(asked) and len(after) < MOST:
        plan = replace(plan, tracker=plan.tracker or asked.added == TRACKED)  # and it stays there
        runs += run_again(plan, asked, len(runs), robot)
        verdict = diagnose_runs(runs, robot).verdict
        found = same_place(verdict, place)
        answers = found.answers if found else [Answer(answer="no_gap", probability=0.0)]
        likely, one = answers[0], verdict.one_answer if found is verdict.places[0] else []
        together = one if likely in one else [likely]
        right = any(is_right(a, plan) for a in together)
        reached.append(sum(a.probability for a in answers if is_right(a, plan) or (right and a in together)))
        after.append((sum(a.probability for a in together), right))
        said += (
            f"; {asked.excitation}{' with ' * bool(asked.added)}{asked.added}, {asked.expected_odds:.2f} expected: "
            f"{' or '.join(map(named, together))} {after[-1][0]:.2f} {'right' if right else 'wrong'}"
        )
        asked = verdict.next_experiment
        if after[-1][0] >= SURE or verdict.unseparated_rivals:
            break
    print(said, flush=True)
    return Settled(bet.probability, expected, reached[0], tuple(after))


def odds_of(x: Settled) -> tuple[float, float, float]:
    """Return the odds before, expected and reached after the first experiment."""
    return x.before, x.expected, x.reached


def main() -> None:
    """Print a line for each case, and the shares."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", default="150000:150040", help="A:B")
    parser.add_argument("--kind", default="under_excited", help="of case")
    parser.add_argument("--seconds", type=float, default=480.0, help="of the processor, at which no case is begun")
    options = parser.parse_args()
    robot, found = load_robot(), []
    for seed in range(*map(int, options.seeds.split(":"))):
        if time.process_time() > options.seconds:
            break
        found += [x] if (x := settled(seed, options.kind, robot)) else []
    for experiments in range(1, MOST + 1):
        answers = [x.by(experiments) for x in found]
        sure = [right for p, right in answers if p >= SURE]
        print(f"after {experiments}: mean odds {np.mean([p for p, _ in answers]):.2f}")
        for name, k, n in (
            ("settled and right", sum(sure), len(found)),
            ("of the settled right", sum(sure), len(sure)),
        ):
            if n:
                low, high = wilson(k / n, n)
                print(f"  {name}: {k} of {n}, {k / n:.2f} [{low:.2f}, {high:.2f}]")
    if found:
        before, expected, reached = (float(np.mean(x)) for x in zip(*map(odds_of, found), strict=True))
        print(f"mean odds {before:.2f} of the best bet before")
        print(f"mean odds of what is at work: {expected:.2f} expected after one, {reached:.2f} reached")


if __name__ == "__main__":
    main()
