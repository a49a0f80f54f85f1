"""Is a report that of this tick and axis? Its echo of the velocity demand tells, since no two commands are alike.

A velocity command travels with a resolution of 1e-6 rpm (3e-11 m/s), so the commands of two ticks, or of two axes, are
the same to the count only where nothing moves or all goes on evenly. An echo that misses the command its drive held up
to this SYNC, and hits an older one or that of another axis, several reports in a row, is a stale or a swapped report.
Where commands do not change nothing is told, and nothing is believed either: the counts go on.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Sequence

from sher3_common.reasons import Reason
from sher3_common.vectors import Vector

from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.trips import Trip, together

_SLACK = 2.0
"""Rounding of command and echo, counts."""
_OLDEST = 16
"""SYNCs whose commands are remembered: the law has stopped the robot for older joint positions long before."""


class FingerprintCheck:
    """Watches whose commands the echoes of the five drives repeat.

    Attributes:
        stale, swapped: reports in a row of each axis that repeat an older command, or that of another axis.
    """

    def __init__(self, scales: Sequence[AxisScale], settings: MotorDriverSettings) -> None:
        self._scales, self._limit = tuple(scales), settings.echo_reports
        self._held: deque[Vector] = deque(maxlen=_OLDEST)
        self.begin()

    def begin(self) -> None:
        """Start afresh."""
        self._held.clear()
        self.stale, self.swapped = [0] * len(self._scales), [0] * len(self._scales)

    def sync(self, held: Vector) -> None:
        """Take note of the commands (5,) [m/s, rad/s] that the drives held up to a SYNC."""
        self._held.append(held)

    def check(self, echo: Vector, unheard: Collection[int] = ()) -> Trip | None:
        """Judge the echoes (5,) [m/s, rad/s] of the newest SYNC, but for axes not heard."""
        if self._held and echo == self._held[-1] and not any(self.stale) and not any(self.swapped):  # nearly always
            return None
        if len(self._held) < 2:
            return None
        return together([self._judge(axis, value) for axis, value in enumerate(echo) if axis not in unheard])

    def _judge(self, axis: int, value: float) -> Trip | None:
        """Judge the echo `value` of one axis."""
        scale, own = self._scales[axis], self._held[-1][axis]
        slack = _SLACK * scale.velocity
        if abs(value - own) <= slack:
            if abs(self._held[-2][axis] - own) > 2.0 * slack:
                self.stale[axis] = self.swapped[axis] = 0
            return None
        age, other = self._age(axis, value, slack), self._other(axis, value, slack)
        self.stale[axis] = self.stale[axis] + 1 if age else 0
        self.swapped[axis] = self.swapped[axis] + 1 if other is not None else 0
        if other is not None and self.swapped[axis] >= self._limit:
            text = f"{scale.name}: its report repeats the command of {self._scales[other].name}"
            return Trip(Reason.FEEDBACK_SWAPPED, text, self.swapped[axis], self._limit - 1, "reports", (axis, other))
        if age and self.stale[axis] >= self._limit:
            text = f"{scale.name}: its report repeats the command of {age} ticks ago"
            return Trip(Reason.FEEDBACK_STALE, text, self.stale[axis], self._limit - 1, "reports", (axis,))
        return None

    def _age(self, axis: int, value: float, slack: float) -> int:
        """Return how many SYNCs ago the axis held the command that this echo repeats; 0 when it never did."""
        for age in range(1, len(self._held)):
            if abs(value - self._held[-1 - age][axis]) <= slack:
                return age
        return 0

    def _other(self, axis: int, value: float, slack: float) -> int | None:
        """Return another axis that held this command up to the newest SYNC."""
        for other, command in enumerate(self._held[-1]):
            if other != axis and command and abs(value - command) <= slack:
                return other
        return None
