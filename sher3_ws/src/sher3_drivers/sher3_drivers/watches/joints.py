"""The checks of encoders and following (`watches.axis`) on all five axes, and over ticks that were lost."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np
from sher3_common.compiled import direct

from sher3_drivers.canopen.tpdo import DriveFeedback
from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.axis import AXIS, AxisCheck, begin_axes, judge_axes
from sher3_drivers.watches.trips import Trip


@cache
def _judge(count: int) -> Callable[..., int]:
    """Return the compiled judgement of so many axes; not kept in the watch, which can be copied."""
    zeros = (0.0,) * count
    return direct(judge_axes, np.zeros(count, AXIS), zeros, zeros, zeros, 0.0)


class JointWatch:
    """The checks of the five axes.

    Attributes:
        axes: one per actuator, in the order of ACTUATORS.
    """

    def __init__(self, scales: Sequence[AxisScale], settings: MotorDriverSettings) -> None:
        self._hole = max(settings.missing_limit * settings.period, settings.stall_limit)
        self._rows = np.zeros(len(scales), AXIS)
        self.axes = [AxisCheck(scale, settings, self._rows, number) for number, scale in enumerate(scales)]
        begin_axes(self._rows, (0.0,) * len(scales), (0.0,) * len(scales))
        _judge(len(scales))

    def check(self, feedback: DriveFeedback, since: float) -> Trip | None:
        """Judge a feedback that came `since` s after the one before; 0 means that there was none before.

        Over ticks that were lost the newest demand is taken to have held. When more than `missing_limit` were lost,
        or more time than the loop may hang, the axes start afresh: the robot has been stopped for that reason by then.
        They start afresh at the first feedback too. All axes whose motors are off their demand are suspected, and all
        whose encoders differ: nobody can say that they brake, so they lose their power at once.
        """
        motor, load = feedback.motor_position, feedback.load_position
        if not 0.0 < since <= self._hole:
            begin_axes(self._rows, motor, load)
            return None
        said: Any = _judge(len(self.axes))(self._rows, motor, load, feedback.velocity_demand, since)
        if not said:
            return None
        objections = [(number, said >> 3 * number & 7) for number in range(len(self.axes))]
        first, what = next(objection for objection in objections if objection[1])
        off = {number for number, said_of_it in objections if said_of_it}
        off.update(np.flatnonzero(self._rows["stray_ticks"] >= self._rows["astray_ticks"]).tolist())
        return self.axes[first].trip(what)._replace(axes=tuple(sorted(off)))
