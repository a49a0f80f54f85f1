"""How many of its units an effort has per unit of a known force: a wrong unit is found before any cause.

effort = share * (known force) + friction. A share of a thousand is an effort in mN that was stated in N; friction and
payload of a thousand times their size would explain it as well.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.fit.fitting import solve
from sher3_diagnosis.quantify.jackknife import standard_error
from sher3_diagnosis.thresholds import JACKKNIFE
from sher3_machines.thresholds import BLOCKS

from sher3_chain.thresholds import LEAST_EXCITED, SLIPPED, SURELY

WRONG_SIGN = 2.0
"""Factor by which the share of a stated gain may be off minus one where its sign alone is wrong."""


class Share(NamedTuple):
    """Units of the recorded effort per unit of the known force; 0 where the motion does not tell it.

    Attributes:
        value: as found; negative where the effort was recorded with the opposite sign.
        error: its standard error, from a jackknife over blocks.
        backwards: whether the effort was recorded with the opposite sign.
        work: that friction takes in the motion, over its standard error; below zero where it would give it.
    """

    value: float
    error: float
    backwards: bool
    work: float = 0.0

    def turned(self) -> Share:
        """Return the share of the effort with its sign put right."""
        return self._replace(value=abs(self.value))

    def sense(self, stated: bool) -> int:
        """Return 1 where the sign is surely as stated, -1 where it is surely the opposite one, else 0.

        With a stated gain a wrong sign alone makes the share about minus one; another one below zero is a force that
        the model lacks, such as that of a payload on a light joint. Of a link that the model hardly has the share is
        any number, and friction tells the sign. A spring that the model lacks may turn the share of an inertia about,
        and an arm that hangs upside down that of all weights; friction that takes work as recorded then says that
        nothing was turned.
        """
        if not self.identified or (stated and abs(self.value) > SLIPPED):
            return int(self.work > LEAST_EXCITED) - int(self.work < -LEAST_EXCITED)
        if not self.backwards:
            return 1
        turned = not stated or 1.0 / WRONG_SIGN < -self.value < WRONG_SIGN
        return -1 if turned and self.work < LEAST_EXCITED else 0

    def off(self, most: float) -> bool:
        """Return whether the share is surely more than `most`, or less than a fifth."""
        size = abs(self.value)
        return self.identified and size > SURELY * self.error and not 1.0 / SLIPPED < size < most

    @property
    def slipped(self) -> bool:
        """Whether an effort with a stated gain is so surely in another scale that its unit is wrong and no drive."""
        return self.off(SLIPPED)

    @property
    def identified(self) -> bool:
        """Whether the motion tells it."""
        return self.value != 0.0

    @property
    def interval(self) -> tuple[float, float]:
        """Interval of 95 %."""
        return self.value - JACKKNIFE * self.error, self.value + JACKKNIFE * self.error


def share_in(x: Array, y: Array) -> Share:
    """Return the share of an effort (n,) in columns (n, 4): the known force, velocity, direction, one."""
    if len(y) < BLOCKS * x.shape[1]:
        return Share(0.0, np.inf, False)
    draws, found = _left_out(x, y), solve(x.T @ x, x.T @ y)
    error = float(standard_error(draws[:, 0]))
    identified = abs(float(found[0])) > LEAST_EXCITED * error
    speed = x[:, 1]
    lost = draws[:, 1] * (speed @ speed) + draws[:, 2] * (speed @ x[:, 2])
    work = float(lost.mean()) / max(float(standard_error(lost)), float(np.finfo(float).tiny))
    backwards = bool(found[0] < 0.0) if identified else work < -LEAST_EXCITED
    return Share(float(found[0]) if identified else 0.0, error, backwards, work)


def _left_out(x: Array, y: Array) -> Array:
    """Coefficients without each block, (BLOCKS, 4)."""
    block = np.arange(len(y)) * BLOCKS // len(y)
    kept = [block != k for k in range(BLOCKS)]
    return np.array([solve(x[k].T @ x[k], x[k].T @ y[k]) for k in kept])
