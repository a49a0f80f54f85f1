"""Bench: whether the experiment that the verdict on an axis names settles what its odds leave open.

    nice python bench/settle_axes.py --seeds 41000:41040      # axes of the ladder, each recorded once

Every axis of `sher3_chain/test/drawn_axes.py` is drawn and diagnosed. Where the best bet has odds between 10 and 90 %
and the verdict foretells what an experiment makes of them, the same axis is recorded once more: in the same motion at
another speed, and judged with both records; or with a known mass on it, described in its second record. Then what has
the same size in both records is the cause, a wrong mass in kg or a wrong force scale as a share; odds are those of
normal errors of the two sizes. Printed are odds of what is at work, as expected and as reached.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
from sher3_chain.axes.foreseen import SPEEDS, WEIGHED
from sher3_common.numbers.shares import wilson
from sher3_diagnosis import diagnose
from sher3_diagnosis.verdict import NextExperiment, Verdict

sys.path.append(str(Path(__file__).parents[1] / "sher3_ws/src/sher3_chain/test"))
from drawn_axes import Drawn, drawn_axis

OPEN, SETTLED = (0.10, 0.90), 0.95
ALIKE = {"payload_mass", "torque_constant"}
SIGMAS = 2.0 * 1.96
"""Standard errors in a 95 % interval."""


def scale_of(drawn: Drawn, verdict: Verdict) -> tuple[float, float] | None:
    """Return force over what the described mass needs, and its standard error, from whichever cause is named."""
    cause = next((c for c in verdict.causes if c.effect in ALIKE), None)
    name = {"payload_mass": "mass", "torque_constant": "relative"}
    told = None if cause is None else cause.parameters.get(name[cause.effect])
    if cause is None or told is None or told.low is None or told.high is None:
        return None
    error = (told.high - told.low) / SIGMAS
    mass = drawn.machine.described.axes[0].mass
    if cause.effect == "payload_mass":
        return 1.0 + told.value / mass, error / mass
    return 1.0 / (1.0 + told.value), error / (1.0 + told.value) ** 2


def odds_of_mass(one: tuple[float, float], two: tuple[float, float], carried: float) -> float:
    """Return the odds that a wrong mass, and no wrong scale, made both ratios; the second with `carried` on it."""
    (a, da), (b, db) = one, two
    scale = (a - b) / np.hypot(da, db)
    mass = ((a - 1.0) - (b - 1.0) * (1.0 + carried)) / np.hypot(da, db * (1.0 + carried))
    return float(1.0 / (1.0 + np.exp(np.clip(0.5 * (mass**2 - scale**2), -50.0, 50.0))))


def reached(seed: int, first: Drawn, before: Verdict, asked: NextExperiment) -> tuple[float, float] | None:
    """Return the odds of what is at work, and of the likeliest answer, after the experiment; None where not told."""
    right = set(asked.separates) & set(first.truth)
    if asked.added == WEIGHED:
        second = drawn_axis(seed, carried=1.0)
        ratios = scale_of(first, before), scale_of(second, diagnose(second.machine, [second.run]).verdict)
        if ratios[0] is None or ratios[1] is None or not right & ALIKE:
            return None
        mass = odds_of_mass(ratios[0], ratios[1], 1.0)
        true = mass if "payload_mass" in right else 1.0 - mass
        return true, max(mass, 1.0 - mass)
    second = drawn_axis(seed, faster=SPEEDS[asked.excitation])
    place = diagnose(first.machine, [first.run, second.run]).verdict.places[0]
    shares = {
        e: sum(a.probability for a in place.answers if e in {c.effect for c in a.causes}) for e in asked.separates
    }
    return max((shares[e] for e in right), default=0.0), max(shares.values())


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
        told = reached(seed, first, verdict, asked)
        said = "not told" if told is None else f"{told[0]:.2f} reached"
        how = " with ".join(filter(None, (asked.excitation, asked.added)))
        print(f"{seed}: {' / '.join(asked.separates)}; {how}: {asked.expected_odds:.2f} expected, {said}", flush=True)
        found += [(asked.added == WEIGHED, asked.expected_odds, *(told or (0.0, 0.0)))]
    for weighed, name in ((True, "a known mass"), (False, "another speed")):
        some = [x[1:] for x in found if x[0] == weighed]
        if some:
            right = sum(true >= SETTLED for _, true, _ in some)
            wrong = sum(likely >= SETTLED > true for _, true, likely in some)
            low, high = wilson(right / len(some), len(some))
            print(
                f"{name}: settled and right {right} of {len(some)} [{low:.2f}, {high:.2f}], settled and wrong {wrong}"
            )
            expected, after, _ = np.mean(some, axis=0)
            print(f"  mean odds of what is at work: {expected:.2f} expected, {after:.2f} reached")


if __name__ == "__main__":
    main()
