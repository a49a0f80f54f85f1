"""Does a drive execute what it was sent? Its echo of the velocity demand against the last commands on the wire.

The echo of a tick is the mean of what the drive executed since the last one, so it lies within the range of the last
commands; how far it lies outside, integrated, is the way the axis has made without being told to. A drive that does not
listen will not listen to a stop either: the driver then withholds the host's heartbeat too.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from operator import mul

from sher3_description.reasons import Reason

from .feedback import Vector
from .settings import MotorDriverSettings
from .trips import Trip
from .units import AxisScale

_COUNTS = 2.0
"""Rounding of command and echo, counts."""


class DemandCheck:
    """Watches the echoes of the five drives.

    Attributes:
        strayed: how far each axis went without being told to, m or rad; forgotten with the memory of the settings.
    """

    def __init__(self, scales: Sequence[AxisScale], settings: MotorDriverSettings) -> None:
        self._scales, self._period = tuple(scales), settings.period
        self._units = tuple([scale.velocity for scale in scales])
        self._limits = [settings.obey_angle if s.revolute else settings.obey_distance for s in scales]
        self._keep = 1.0 - min(1.0, settings.period / settings.following_memory)
        self._sent: deque[Vector] = deque(maxlen=max(2, math.ceil(settings.obey_latency / settings.period - 1e-9)))
        self.strayed = [0.0] * len(scales)

    def begin(self) -> None:
        """Start afresh."""
        self._sent.clear()
        self.strayed = [0.0] * len(self._scales)

    def sent(self, counts: Sequence[int]) -> None:
        """Take note of a velocity command on its way to the drives, in their counts."""
        self._sent.append(tuple(map(mul, counts, self._units)))

    @property
    def newest(self) -> Vector:
        """The newest command on the wire (5,) [m/s, rad/s]; zero before the first."""
        return self._sent[-1] if self._sent else (0.0,) * len(self._scales)

    def check(self, echo: Vector) -> Trip | None:
        """Judge the echoes (5,) [m/s, rad/s] of a tick."""
        if not self._sent:
            return None
        for axis, scale in enumerate(self._scales):
            value, slack = echo[axis], _COUNTS * scale.velocity
            if abs(value - self._sent[-1][axis]) <= slack and not self.strayed[axis]:
                continue
            commands = [sent[axis] for sent in self._sent]
            outside = max(value - max(commands) - slack, min(commands) - slack - value, 0.0)
            way = self.strayed[axis] = self._keep * self.strayed[axis] + outside * self._period
            if way > self._limits[axis]:
                unit = "rad" if scale.revolute else "m"
                text = f"{scale.name}: executes {value:.3g} {unit}/s, was sent {commands[-1]:.3g} {unit}/s"
                return Trip(Reason.DRIVE_DISOBEYS, text, way, self._limits[axis], unit)
            if way < 1e-3 * self._limits[axis]:
                self.strayed[axis] = 0.0
        return None
