"""How probable each answer to an item is: an effect of the library, something outside it, or no gap of its own."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from sher3_diagnosis.finding import LIBRARY, NO_GAP, OUTSIDE, ExactFinding, Item, Judged
from sher3_diagnosis.judge.calibration.calibration import Calibration
from sher3_diagnosis.judge.calibration.typical import trust
from sher3_diagnosis.judge.evidence.scales import scaled_cause, scaled_exact, scaled_gap
from sher3_diagnosis.verdict import Interval, Place


def judged(item: Item, calibration: Calibration, closure: Interval | None = None) -> Judged:
    """Return an item with its probabilities and, of a cause, its closure.

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
    shares = np.exp(-calibration.sharpness * (far - far.min()))
    effects = found[LIBRARY] * shares / shares.sum()
    return Judged(item, tuple(effects.tolist()), found[OUTSIDE], found[NO_GAP], closure, typicality)


def reproduced(stage: ExactFinding, calibration: Calibration) -> float:
    """Return the probability that the causes of an exact stage are those at work; 0 without one."""
    if not stage.causes:
        return 0.0
    return calibration.exact.probabilities(scaled_exact(stage.closure.value))[LIBRARY]


def of_first(places: Sequence[Place]) -> dict[str, float]:
    """Return answer -> probability at the first place; causes that act together are joined by `+`."""
    out: dict[str, float] = defaultdict(float)
    for answer in places[0].answers if places else ():
        out[answer.answer or "+".join(f"{c.effect}:{c.actuator}" for c in answer.causes)] += answer.probability
    return dict(out) or {NO_GAP: 1.0}
