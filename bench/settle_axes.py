"""Bench: whether the experiment that the verdict on an axis names settles what its odds leave open.

    nice python bench/settle_axes.py --seeds 41000:41040      # axes of the ladder, each recorded once

Every axis of `sher3_chain/test/drawn_axes.py` is drawn and diagnosed. Where the best bet has odds between 10 and 90 %
and the verdict foretells what an experiment makes of them, the same axis is recorded once more: in the same motion at
another speed, or with a known mass on it that is described as `carried`, and judged with both records. Printed are odds
of what is at work, as expected and as reached.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from sher3_chain.axes.foreseen import SPEEDS, WEIGHED
from sher3_chain.axes.machine import Axes
from sher3_common.numbers.shares import wilson
from sher3_diagnosis import diagnose
from sher3_diagnosis.verdict import NextExperiment

sys.path.append(str(Path(__file__).parents[1] / "sher3_ws/src/sher3_chain/test"))
from drawn_axes import Drawn, drawn_axis

OPEN, SETTLED = (0.10, 0.90), 0.95


def reached(seed: int, first: Drawn, asked: NextExperiment) -> tuple[float, float]:
    """Return the odds of what is at work, and of the likeliest answer, after the experiment that a verdict names."""
    weighed = asked.added == WEIGHED
    second = drawn_axis(seed, carried=1.0) if weighed else drawn_axis(seed, faster=SPEEDS[asked.excitation])
    (axis,) = first.machine.described.axes
    axis = axis.model_copy(update={"carried": {"second": axis.mass} if weighed else {}})
    machine = Axes(first.machine.described.model_copy(update={"axes": (axis,)}))
    place = diagnose(machine, [first.run, replace(second.run, name="second")]).verdict.places[0]
    shares = {
        e: sum(a.probability for a in place.answers if e in {c.effect for c in a.causes}) for e in asked.separates
    }
    return max((shares[e] for e in asked.separates if e in first.truth), default=0.0), max(shares.values())


def shares(name: str, some: list[tuple[float, float, float]]) -> None:
    """Print the shares that were settled: odds as expected and as reached of what is at work, and of the likeliest."""
    if some:
        right = sum(true >= SETTLED for _, true, _ in some)
        wrong = sum(likely >= SETTLED > true for _, true, likely in some)
        low, high = wilson(right / len(some), len(some))
        print(f"{name}: settled and right {right} of {len(some)} [{low:.2f}, {high:.2f}], settled and wrong {wrong}")
        expected, after, _ = np.mean(some, axis=0)
        print(f"  mean odds of what is at work: {expected:.2f} expected, {after:.2f} reached")


def main() -> None:
    """Print a line for each open axis, and the shares."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", default="41000:41040", help="A:B")
    found = []
    for seed in range(*map(int, parser.parse_args().seeds.split(":"))):
        first = drawn_axis(seed)
        verdict = diagnose(first.machine, [first.run]).verdict
        bet, asked = verdict.places[0].bet if verdict.places else None, verdict.next_experiment
        if bet is None or asked is None or asked.expected_odds is None or not OPEN[0] < bet.probability < OPEN[1]:
            continue
        told = reached(seed, first, asked)
        how = " with ".join(filter(None, (asked.excitation, asked.added)))
        print(
            f"{seed}: {' / '.join(asked.separates)}; {how}: {asked.expected_odds:.2f} expected, {told[0]:.2f} reached",
            flush=True,
        )
        found += [(asked.added == WEIGHED, asked.expected_odds, *told)]
    for weighed, name in ((True, "a known mass"), (False, "another speed")):
        shares(name, [x[1:] for x in found if x[0] == weighed])


if __name__ == "__main__":
    main()
