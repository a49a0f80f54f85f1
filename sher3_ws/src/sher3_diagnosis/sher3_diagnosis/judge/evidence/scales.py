"""The scales on which a model reads the evidence: logarithms of shares, each down to where it tells nothing more."""

from __future__ import annotations

import math
from collections.abc import Mapping

LEAST_SHARE = 0.003
"""Share of a gap below which a remainder is none, whatever explains it."""
LEAST_FLOORS = 0.3
"""Power over the floor below which a remainder is none: a healthy robot as built leaves as much."""
MOST_POWER = 10.0
"""Power of a gap over its threshold, or of a remainder over the floor, above which either is beyond doubt. A larger
power tells nothing more and counts as this one."""
MOST_FLOORS = 25.0
"""Gap over floor above which a gap is beyond doubt. A larger gap counts as this one, so that its size is not unusual:
the upper end of what labelled robots are drawn with (`sher3_challenge.calibration.drawn.GAP`)."""
BENT = 0.10
"""Share of a gap that a right law leaves at most by its own shape, which differs from machine to machine: the upper end
of what labelled robots are drawn with (`sher3_challenge.plants.level.SHAPE`). So much is as likely another law's."""
WHOLE = 0.75
"""Say of the share of the whole gap in what several causes leave. Of 0.5, 0.6, 0.75 and 1 the likeliest on labelled
axes, arms and robots (`bench/imperfect.py`, `bench/other_odds.py`)."""
LEAST_OWN = 0.02
"""Of what is left, the share that no input explains. Below this the remainder belongs to the inputs beyond doubt."""


def log_above(x: float, least: float) -> float:
    """Return the natural logarithm of the larger of `x` and `least`."""
    return math.log(max(x, least))


def scaled_gap(numbers: Mapping[str, float]) -> dict[str, float]:
    """Return what a model reads of a gap without a cause: the larger, the less it comes from elsewhere."""
    return {
        "power": log_above(min(numbers["power"], MOST_POWER), 1.0),
        "alone": -max(0.0, numbers["beside"]),
    }


def scaled_exact(closure: float) -> dict[str, float]:
    """Return what a model reads of an exact stage: the share of its error that the causes do not reproduce."""
    return {"missed": 1.0 - closure}


def scaled_cause(numbers: Mapping[str, float]) -> dict[str, float]:
    """Return what a model reads of a cause; the larger a number but the size, the less it speaks for the cause.

    What nothing tells is not there, so that it speaks neither for the cause nor against it.
    """
    floors, bare = max(numbers["power"], 0.0), _share(strange(numbers))
    left = beside_others(bare, numbers)
    steady = {"spread": log_above(numbers["spread"], 0.001)} if "spread" in numbers else {}
    return (
        _foreign(numbers)
        | steady
        | {
            "left": log_above(left, LEAST_SHARE),
            "complete": 0.0 if numbers["idealised"] else log_above(left, LEAST_SHARE) - math.log(LEAST_SHARE),
            "floors": log_above(min(bare * floors, MOST_POWER), LEAST_FLOORS),
            "mismatch": log_above(numbers["mismatch"], 0.01),
            "size": log_above(min(numbers["ratio"], MOST_FLOORS), 1.0),
        }
    )


def beside_others(left: float, numbers: Mapping[str, float]) -> float:
    """Return what a share that is left of a cause's part of a gap weighs beside the causes of the other parts.

    What several causes leave is one remainder. Were all of them right, it would be the bends of all of them, a share of
    the whole gap; were one foreign, a share of that one's part. The odds fall with both, and more with the first: in
    logarithms the share of the whole counts `WHOLE`, that of the part the rest.
    """
    return float(left * numbers.get("part", 1.0) ** WHOLE)


def share_of_whole(numbers: Mapping[str, float]) -> float:
    """Return what is left, bends of the law too, as a share of the whole gap, no less than what is told."""
    return min(max(numbers["left"] * numbers.get("part", 1.0), LEAST_SHARE), 1.0)


def strange(numbers: Mapping[str, float]) -> float:
    """Return the share left that is, on average, no bend of the law.

    It is what does not go with the law, and of what does the share that is likely another law's: half of it where it is
    as much as right laws leave at most, the less the smaller it is. Where nothing says what goes with the law (evidence
    of before), all that is left counts.
    """
    left = numbers["left"]
    stray = numbers.get("stray", left)
    bend = max(0.0, left - stray)
    return stray + bend * bend / (bend + BENT)


def unexplained_share(numbers: Mapping[str, float], of: str = "left", least: float = 0.0) -> float:
    """Return the share of what is left that no function of whatever was recorded explains, `LEAST_OWN` to 1.

    Args:
        numbers: evidence of a cause, of which free laws were looked at.
        of: `left`, or `law` for what a free law of the own inputs leaves.
        least: share of the gap that is nothing, whatever explains it; what is below the floor is nothing either.
    """
    left, anything = (beside_others(_share(numbers[name]), numbers) for name in (of, "anything"))
    explained = max(0.0, left - max(anything, least)) / max(left, least, 1.0 / max(numbers["power"], 1.0))
    return max(1.0 - explained, LEAST_OWN)


def _foreign(numbers: Mapping[str, float]) -> dict[str, float]:
    """Return how far others explain what own inputs leave; nothing where free laws were not looked at.

    A bend of the law is its own, whoever tells where it bends: what they explain counts as far as it is strange.
    """
    if "law" not in numbers:
        return {}
    theirs = 1.0 - unexplained_share(numbers, "law", LEAST_SHARE)
    return {"foreign": -math.log(1.0 - theirs * _share(strange(numbers) / max(numbers["left"], LEAST_SHARE)))}


def _share(x: float) -> float:
    return min(max(x, 0.0), 1.0)
