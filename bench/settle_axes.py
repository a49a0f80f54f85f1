"""Bench: whether the experiments that the verdicts on an axis name settle what its odds leave open.

    nice python bench/settle_axes.py --seeds 41000:41040      # axes of the ladder, each recorded once

Every axis of `sher3_chain/test/drawn_axes.py` is drawn and diagnosed. Where the best bet has odds between 10 and 90 %
and the verdict foretells what an experiment makes of them, the same axis is recorded once more: in the same motion at
another speed, or with a known mass on it that is described as `carried`, and judged with all records; where that does
not settle these rivals (`SURE`), what the new verdict names for them follows. Rivals of which the verdict says that
nothing tells them apart are one answer. Printed are odds of what is at work, as expected and as reached.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from settle import MOST, OPEN, foretold
from sher3_chain.axes.foreseen import SPEEDS, WEIGHED
from sher3_chain.axes.machine import Axes
from sher3_challenge.calibration.table import SURE
from sher3_common.numbers.shares import wilson
from sher3_diagnosis import diagnose
from sher3_diagnosis.verdict import NextExperiment, Verdict

sys.path.append(str(Path(__file__).parents[1] / "sher3_ws/src/sher3_chain/test"))
from drawn_axes import Drawn, drawn_axis


class Reached(NamedTuple):
    """Odds of what is at work, as expected after the first experiment and as reached, and those of the likeliest."""

    expected: float
    right: float
    likely: float


def again(seed: int, first: Drawn, asked: Sequence[NextExperiment]) -> Verdict:
    """Return the verdict on an axis that is recorded once more for each experiment."""
    records, carried = [first.run], {}
    (axis,) = first.machine.described.axes
    for n, each in enumerate(asked):
        name, weighed = f"more_{n}", each.added == WEIGHED
        drawn = drawn_axis(seed, carried=1.0) if weighed else drawn_axis(seed, faster=SPEEDS[each.excitation])
        records.append(replace(drawn.run, name=name))
        carried |= {name: axis.mass} if weighed else {}
    machine = Axes(first.machine.described.model_copy(update={"axes": (axis.model_copy(update={"carried": carried}),)}))
    return diagnose(machine, records).verdict


def odds_of(verdict: Verdict, effects: Iterable[str]) -> float:
    """Return the odds of the answers that hold one of some effects."""
    found = (a for a in verdict.places[0].answers if set(effects) & {c.effect for c in a.causes})
    return sum(a.probability for a in found)


def alike(verdict: Verdict, effect: str) -> set[str]:
    """Return the effects that are one answer with an effect, as a verdict says."""
    named = {name.split(":")[0] for name in (verdict.next_experiment.alike if verdict.next_experiment else ())}
    return named if effect in named else {effect}


def settled(seed: int) -> tuple[bool, Reached] | None:
    """Draw an axis, record what its verdicts name, print a line and return whether it is weighed, and the odds."""
    first = drawn_axis(seed)
    verdict = diagnose(first.machine, [first.run]).verdict
    bet, asked = verdict.places[0].bet if verdict.places else None, verdict.next_experiment
    if bet is None or not foretold(asked) or not OPEN[0] < bet.probability < OPEN[1]:
        return None
    rivals, made, said, found = asked.separates, list[NextExperiment](), [], []
    expected = asked.expected_odds
    while foretold(asked) and {*rivals} & {*asked.separates} and len(made) < MOST:
        made.append(asked)
        verdict = again(seed, first, made)
        odds = {e: odds_of(verdict, alike(verdict, e)) for e in rivals}
        right = max((p for e, p in odds.items() if alike(verdict, e) & first.truth.keys()), default=0.0)
        found.append(Reached(expected, right, max(odds.values())))
        how = " with ".join(filter(None, (asked.excitation, asked.added)))
        said.append(f"{how}: {asked.expected_odds:.2f} expected, {right:.2f} reached")
        asked = verdict.next_experiment
        if max(odds.values()) >= SURE:
            break
    print(f"{seed}: {' / '.join(rivals)}; {'; then '.join(said)}", flush=True)
    return made[0].added == WEIGHED, found[-1]


def shares(name: str, some: Sequence[Reached]) -> None:
    """Print the shares that were settled."""
    if some:
        right = sum(x.right >= SURE for x in some)
        wrong = sum(x.likely >= SURE > x.right for x in some)
        low, high = wilson(right / len(some), len(some))
        print(f"{name}: settled and right {right} of {len(some)} [{low:.2f}, {high:.2f}], settled and wrong {wrong}")
        expected, after, _ = np.mean(some, axis=0)
        print(f"  mean odds of what is at work: {expected:.2f} expected, {after:.2f} reached")


def main() -> None:
    """Print a line for each open axis, and the shares."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", default="41000:41040", help="A:B")
    seeds = range(*map(int, parser.parse_args().seeds.split(":")))
    found = [x for x in map(settled, seeds) if x is not None]
    for weighed, name in ((True, "a known mass"), (False, "another speed")):
        shares(name, [x for kind, x in found if kind == weighed])


if __name__ == "__main__":
    main()
