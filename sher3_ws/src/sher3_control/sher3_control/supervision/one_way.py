"""While the axes go one way, what force sensor and drives feel together stays as it was: what holds still, cancels.

Friction in the screws and a weight that the robot file does not know make a level of the sum that nobody can tell from
a false force (`hand_level`). Both stay what they are while no axis turns round and the tool hardly turns. So along such
a way the sum is judged finer, against its mean at the begin of the way: a gain that grows, a sensor that is turned
under a hand that grows, a hand that fades from a sensor that stays. What changes while nothing moves is forgotten.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
PLAY = np.array([1e-5, 1e-5, 1e-5, 5e-4, 1e-5])
"""How far an axis comes back before it has turned round [m, rad]: further than a tremor leads it, and than the screws'
friction takes to change its sign; 0.5 mrad of roll are 10 um at a point 20 mm up the shaft."""
TURN = np.array([np.inf, np.inf, np.inf, 0.2, 6e-3])
"""How far roll and tilt's slider go along one way [rad, m]: 0.2 rad of turning, by which 20 g weigh 0.04 N
elsewhere."""


class OneWay:
    """Judges the sum of what sensor and drives feel against its mean at the begin of a way.

    Args:
        lag: time constant of the means, and how long after its begin a way has one [s].
        memory: time constant with which the mean follows while nothing moves [s].
    """

    def __init__(self, lag: float, memory: float) -> None:
        self._lag, self._memory = lag, memory
        self.begin()

    def begin(self) -> None:
        """Forget all: the drives have just got their power, or are about to."""
        self._age, self._whole, self._means, self._first = 0.0, 0.0, np.zeros((2, 0)), np.zeros((2, 0))
        self._before = self._came = np.zeros(0)
        self._places = self._start = self._sense = np.zeros(0)

    def follow(self, step: float, felt: Array, held: Array, joints: Array, moves: bool) -> Array:
        """Take a tick.

        Args:
            step: how long it lasted [s].
            felt: by the sensor (5,) [N].
            held: by the drives (5,) [N].
            joints: load encoders (5,), m and rad.
            moves: whether the law moves the tip.

        Returns:
            By how much the sum, and by how much what the drives hold, changed along the way, and how much of a hand
            came while its first mean was taken (3, 5) [N]. Zero while nothing moves; the changes are zero before a way
            has a mean.
        """
        now = np.array([felt + held, held])
        if self._whole == 0.0:
            self._means, self._places, self._start, self._sense = now, joints, joints, np.zeros(len(joints))
            self._before = held
        self._whole += step
        if self._turned_round(joints):
            self._age, self._before = 0.0, self._means[1]
        else:
            self._age += step
        self._means = self._means + min(1.0, step / min(self._lag, self._whole)) * (now - self._means)
        if self._age < self._lag:
            self._first, self._came = self._means, self._means[1] - self._before
        elif not moves:
            forgotten = min(1.0, step / self._memory)
            self._first = self._first + forgotten * (self._means - self._first)
            self._came = (1.0 - forgotten) * self._came
        return np.vstack([self._means - self._first, self._came]) * moves

    def _turned_round(self, joints: Array) -> bool:
        """Return whether an axis came back by its play, or the tool turned too far; a new way begins then."""
        places = np.clip(self._places, joints - PLAY, joints + PLAY)
        went, self._places = np.sign(places - self._places), places
        new = bool((went * self._sense < 0.0).any() or (np.abs(joints - self._start) > TURN).any())
        if new:
            self._start, self._sense = joints, went
        else:
            self._sense = np.where(went == 0.0, self._sense, went)
        return new
