"""Does a drive execute what it was sent? Its echo of the velocity demand against the newest commands on the wire.

The echo of a tick is the mean of the velocity the drive executed since the last tick, so it lies within the range of
the newest commands. Whatever lies outside that range, integrated over time, is travel that nobody asked for. A drive
that does not obey a command will not obey a stop either: then the driver withholds the host's heartbeat too
(`MotionWatch.deaf`).

A drive that stops is told its own ramp, and it may be at rest before.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from operator import mul

from sher3_common.reasons import Reason
from sher3_common.vectors import Vector

from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.trips import Trip, together

_COUNTS = 2.0
"""Counts by which an echo may differ from its command: one for the rounding of each."""
_FORGOTTEN = 1e-3
"""Share of the limit below which travel that nobody asked for is set to zero, so that the quick test passes again."""
_ROUNDING = 1e-9
"""Slack of a quotient before it is rounded up to whole ticks."""


class DemandCheck:
    """Watches the echoes of the five drives.

    Attributes:
        strayed: travel of each axis that nobody asked for, m or rad; it fades with `following_memory`.
    """

    def __init__(self, scales: Sequence[AxisScale], settings: MotorDriverSettings) -> None:
        self._scales, self._period = tuple(scales), settings.period
        self._units = tuple([scale.velocity for scale in scales])
        self._limits = [settings.obey_angle if s.revolute else settings.obey_distance for s in scales]
        self._keep = 1.0 - min(1.0, settings.period / settings.following_memory)
        ticks = math.ceil(settings.obey_latency / settings.period - _ROUNDING)
        self._sent: deque[Vector] = deque(maxlen=max(2, ticks))
        self._steps = tuple([scale.stop_step(settings.period) for scale in scales])
        self._brakes = False
        self.strayed = [0.0] * len(scales)

    def begin(self) -> None:
        """Start afresh."""
        self._sent.clear()
        self.strayed = [0.0] * len(self._scales)

    def sent(self, counts: Sequence[int]) -> None:
        """Take note of a velocity command (5,) on its way to the drives, in their counts."""
        self._sent.append(tuple(map(mul, counts, self._units)))
        self._brakes = False

    def stopped(self) -> None:
        """Take note that the drives are told to brake: from the next SYNC on each is slower by its ramp."""
        self._brakes = True

    def sync(self) -> None:
        """Take note of a SYNC, which ends a period of a ramp."""
        if self._brakes:
            self._sent.append(tuple(map(_slower, self.newest, self._steps)))

    @property
    def newest(self) -> Vector:
        """The newest command on the wire (5,) [m/s, rad/s]; zero before the first."""
        return self._sent[-1] if self._sent else (0.0,) * len(self._scales)

    @property
    def braked(self) -> bool:
        """Whether the drives are told to stop, and their ramps have been over for as long as a command takes to show.

        A velocity loop of the nominal robot has 13 % of its speed left then, and no less than 8 % after 27 ms.
        """
        return self._brakes and not any(map(any, self._sent))

    def check(self, echo: Vector) -> Trip | None:
        """Judge the echoes (5,) [m/s, rad/s] of a tick."""
        if not self._sent or (echo == self._sent[-1] and not any(self.strayed)):  # nearly always
            return None
        return together([self._judge(axis, value) for axis, value in enumerate(echo)])

    def _judge(self, axis: int, value: float) -> Trip | None:
        """Judge the echo `value` of one axis."""
        slack = _COUNTS * self._units[axis]
        if abs(value - self._sent[-1][axis]) <= slack and not self.strayed[axis]:
            return None
        return self._stray(axis, value, slack)

    def _stray(self, axis: int, value: float, slack: float) -> Trip | None:
        """Integrate how far the echo `value` of an axis lies outside the range of its newest commands."""
        commands = [sent[axis] for sent in self._sent] + [0.0] * self._brakes
        outside = max(value - max(commands) - slack, min(commands) - slack - value, 0.0)
        travel = self._keep * self.strayed[axis] + outside * self._period
        limit, scale = self._limits[axis], self._scales[axis]
        self.strayed[axis] = 0.0 if travel < _FORGOTTEN * limit else travel
        if travel <= limit:
            return None
        unit = scale.unit
        text = f"{scale.name}: executes {value:.3g} {unit}/s, was sent {commands[-1]:.3g} {unit}/s"
        return Trip(Reason.DRIVE_DISOBEYS, text, travel, limit, unit, (axis,))


def _slower(velocity: float, step: float) -> float:
    """Return a velocity that has come nearer to zero by `step`."""
    return math.copysign(max(0.0, abs(velocity) - step), velocity)
