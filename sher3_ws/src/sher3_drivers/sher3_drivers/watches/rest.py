"""Does a robot rest that is to rest? After the braking time every axis must stay where it then is, in every state."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import count, repeat

from sher3_common.reasons import Reason
from sher3_common.vectors import Vector

from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.trips import Trip, together

_WHEN = {Reason.STOP_NOT_OBEYED: "after the stop", Reason.MOVED_DISABLED: "while the robot is disabled"}


class RestCheck:
    """Watches the departures of a robot that is stopped or disabled.

    Attributes:
        resting: the braking time is over.
        disobeyed: an axis moved as it must not, while it braked or after that.
    """

    def __init__(self, scales: Sequence[AxisScale], settings: MotorDriverSettings) -> None:
        self._scales = tuple(scales)
        self._limits = [settings.rest_angle if scale.revolute else settings.rest_distance for scale in scales]
        self._brake = round(settings.brake_time * 1e9)
        self.resting = self.disobeyed = False

    def begin(self) -> None:
        """Forget the last rest: another one begins."""
        self.resting = self.disobeyed = False

    def begins_now(self, since: int, now: int) -> bool:
        """Return whether the axes have just had the time to brake, in a rest that began at `since` [ns]."""
        if self.resting or now - since < self._brake:
            return False
        self.resting = True
        return True

    def check(self, moved: Vector, reason: Reason) -> Trip | None:
        """Object, for `reason`, to the axes that have `moved` (5,) [m, rad] since they rest."""
        return together(map(self._judge, count(), map(abs, moved), repeat(reason))) if self.resting else None

    def _judge(self, axis: int, way: float, reason: Reason) -> Trip | None:
        limit, scale = self._limits[axis], self._scales[axis]
        if way <= limit:
            return None
        text = f"{scale.name}: moved {way:.3g} {scale.unit} {_WHEN[reason]} (limit {limit:.3g})"
        return Trip(reason, text, way, limit, scale.unit, (axis,))
