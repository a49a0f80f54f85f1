"""How far one machine is from its pages: nobody knows beforehand, and what its places leave tells each of the others.

Weights were set on robots that are imperfect to 0.3 to 10 %. A machine of which the drawing alone is known may be worse
at every place. What a right cause leaves is then compared with the level L of that machine, and not with those robots:

    P(right | left) = sum over L of P(L | what its other places leave) P(right | left, L),

where what is left of the gap, over what laws explain of it, counts in units of the level. The level at a place is told
by the other places alone: otherwise a wrong cause, which leaves much, would excuse itself.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.finding import Item
from sher3_diagnosis.judge.evidence.scales import LEAST_SHARE, share_of_whole, unexplained_share

LEVELS = (0.003, 0.01, 0.03, 0.1, 0.3)
"""Levels of a machine, equally likely beforehand: from the best labelled robots to three times the worst."""
USUAL = 0.017
"""Level that the weights take for granted: the middle of what labelled robots are drawn with (`SHAPE`)."""
SPREAD = 1.0
"""Standard deviation of the logarithm of what one place leaves about its machine's level: 0.5 on labelled axes, 0.7 on
arms in motion, 0.3 on arms seen from outside (`bench/imperfect.py`), and more on machines whose parts are unlike."""
FOREIGN = (0.3, 0.2, 1.0)
"""Share of places whose cause is foreign, and middle and spread of what is left there: it tells no level."""
LAWFUL = (1.25, 0.6)
"""Exponent of the shares that no function explains, and their mean at which they speak neither way. Of 1 to 1.5 and 0.5
to 0.7 within 1 of the least log loss, 159 on 174 places of axes and arms, of which half have foreign causes that count
half, and on their causes (`bench/imperfect.py`, `bench/other_odds.py`)."""
BENT_BY = 1e-4
"""Share of the gap below which what is left is nothing, whatever explains it: the power of a law bent by 1 %, as those
of good machines are. The log loss above grows by 1 with it; a tenth as much lowers it by 3."""
SHARES = ("left", "stray")
"""Evidence that is a share of the gap."""


def level_weights(items: Sequence[Item]) -> list[Array]:
    """Return for each cause or gap the weight of each level, as the causes of the other places tell, (k,)."""
    left: dict[Channel, list[float]] = {}
    for item in (i for i in items if i.index is not None):
        left.setdefault(item.channel, []).append(math.log(share_of_whole(at_level(item.numbers, USUAL))))
    likely = {channel: _likely(float(np.mean(x))) for channel, x in left.items()}
    return [_normalised([x for channel, x in likely.items() if channel != item.channel]) for item in items]


def at_level(numbers: Mapping[str, float], level: float) -> dict[str, float]:
    """Return the evidence of a cause with its shares in units of a level, that of labelled robots or a worse one.

    A level is a share of what all laws of the gap do: bent by L they leave L / (1 + L) of it. Whose law the rest
    follows is no matter of a level: `lawful` asks that once.
    """
    laws = max(1.0 - max(numbers["left"], 0.0) * numbers.get("part", 1.0), LEAST_SHARE)
    unit = laws * max(1.0, level / USUAL)
    return {name: x / unit if name in SHARES else x for name, x in numbers.items() if name != "law"}


def lawful(numbers: Mapping[str, float]) -> float:
    """Return the factor that what is left puts on the odds of a foreign law; 1 where no free law was looked at.

    Of a machine whose level nobody knows, how much is left tells little; whether it is a law tells more. A foreign law
    is a function of something: free functions of what was recorded miss a tenth of it, or a hundredth. What a right
    cause leaves is drift, waves and what nobody recorded: they mostly miss more than half. What only other inputs than
    the cause's own explain is asked for twice: it is no other shape of its law.
    """
    if "anything" not in numbers:
        return 1.0
    exponent, even = LAWFUL
    left, law = (unexplained_share(numbers, of, BENT_BY) for of in ("left", "law"))
    return float((even**2 / (left * law)) ** exponent)


def _normalised(likely: Sequence[Array]) -> Array:
    weight = np.prod([np.ones(len(LEVELS)), *likely], axis=0)
    return np.asarray(weight / weight.sum())


def _likely(log_left: float) -> Array:
    """Return how likely each level makes what is left of a place, (k,)."""
    share, middle, spread = FOREIGN
    right = _bell((log_left - np.log(LEVELS)) / SPREAD) / SPREAD
    return (1.0 - share) * right + share * _bell((log_left - math.log(middle)) / spread) / spread


def _bell(x: Array | float) -> Array:
    return np.exp(-0.5 * np.square(x))
