"""How probable each answer to an item is: an effect of the library, something outside it, or no gap of its own."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sher3_diagnosis.channel import Array
from sher3_diagnosis.finding import LIBRARY, NO_GAP, OUTSIDE, ExactFinding, Item, Judged
from sher3_diagnosis.judge.calibration.calibration import Calibration
from sher3_diagnosis.judge.calibration.typical import trust
from sher3_diagnosis.judge.evidence.scales import scaled_cause, scaled_exact, scaled_gap
from sher3_diagnosis.judge.level import LEVELS, at_level, lawful, level_weights
from sher3_diagnosis.verdict import Interval, Place


def judged_together(
    items: Sequence[Item], closures: Sequence[Interval | None], calibration: Calibration, own_level: bool
) -> list[Judged]:
    """Return the items of one machine with their probabilities.

    Args:
        items: causes and gaps of all its parts.
        closures: of each cause; None of a gap.
        calibration: the weights.
        own_level: whether the machine is as far from its pages as it tells by itself (`judge.level`), and not as far
            as the robots that set the weights.
    """
    if not own_level:
        return [judged(i, calibration, c) for i, c in zip(items, closures, strict=True)]
    return [
        _over_levels(i, calibration, c, weight)
        for i, c, weight in zip(items, closures, level_weights(items), strict=True)
    ]


def _over_levels(item: Item, calibration: Calibration, closure: Interval | None, weight: Array) -> Judged:
    """Return an item with its probabilities over all levels of its machine, (k,) weights."""
    if item.index is None:
        return judged(item, calibration)
    each = [judged(replace(item, numbers=at_level(item.numbers, x)), calibration, closure) for x in LEVELS]
    odds = weight @ np.array([(*j.effects, j.outside, j.no_gap) for j in each])
    odds[-2] *= lawful(item.numbers)
    *effects, outside, no_gap = (odds / odds.sum()).tolist()
    return replace(each[0], item=item, effects=tuple(effects), outside=outside, no_gap=no_gap)


def judged(item: Item, calibration: Calibration, closure: Interval | None = None) -> Judged:
    """Return an item of a machine like the labelled ones with its probabilities and, of a cause, its closure.

    A closure of exactly 0 says that over all runs there is nothing above the floor that could be closed: no gap.
    """
    if item.index is None:
        found = calibration.gap.probabilities(scaled_gap(item.numbers))
        return Judged(item, (), found[OUTSIDE], found[NO_GAP])
    if closure is not None and closure.value == 0.0:
        return Judged(item, (0.0,) * len(item.candidates), 0.0, 1.0, closure)
    numbers = scaled_cause(item.numbers)
    typicality = calibration.typicality(numbers)
    found = calibration.cause.probabilities(numbers, trust(typicality))
    far = np.array([c.unlikeness for c in item.candidates])
    effects = found[LIBRARY] * shares_of(far, calibration)
    return Judged(item, tuple(effects.tolist()), found[OUTSIDE], found[NO_GAP], closure, typicality)


def shares_of(unlikeness: Array, calibration: Calibration) -> Array:
    """Return how candidates that are (k,) unlike the best share the probability of the library, (k,)."""
    shares = np.exp(-calibration.sharpness * (unlikeness - unlikeness.min()))
    return np.asarray(shares / shares.sum())


def reproduced(stage: ExactFinding, calibration: Calibration) -> float:
    """Return the probability that the causes of an exact stage are those at work; 0 without one."""
    if not stage.causes:
        return 0.0
    return calibration.exact.probabilities(scaled_exact(stage.closure.value))[LIBRARY]


def first_place_odds(places: Sequence[Place]) -> dict[str, float]:
    """Return answer -> probability at the first place; causes that act together are joined by `+`."""
    out: dict[str, float] = defaultdict(float)
    for answer in places[0].answers if places else ():
        out[answer.answer or "+".join(f"{c.effect}:{c.actuator}" for c in answer.causes)] += answer.probability
    return dict(out) or {NO_GAP: 1.0}
