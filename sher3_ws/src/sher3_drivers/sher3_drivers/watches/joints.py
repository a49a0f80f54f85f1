"""The checks of encoders and following (`watches.axis`) on all five axes, and over ticks that were lost."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_drivers.canopen.tpdo import DriveFeedback
from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.axis import AxisCheck, AxisLimits
from sher3_drivers.watches.trips import Trip

_HOLE = 10
"""Lost ticks that are bridged at most: after as many (`missing_limit`) the driver has stopped the robot."""


class JointWatch:
    """The checks of the five axes.

    Attributes:
        axes: one per actuator, in the order of ACTUATORS.
    """

    def __init__(self, scales: Sequence[AxisScale], settings: MotorDriverSettings) -> None:
        self._hole = max(_HOLE * settings.period, settings.stall_limit)
        self.axes = [AxisCheck(scale.name, scale.unit, AxisLimits.of(scale, settings)) for scale in scales]

    def check(self, feedback: DriveFeedback, since: float) -> Trip | None:
        """Judge a feedback that came `since` s after the one before; 0 means that there was none before.

        Over ticks that were lost the newest demand is taken to have held. When more than `_HOLE` of them were lost, or
        more time than the loop may hang, the axes start afresh: the robot has been stopped for that reason by then.
        They start afresh at the first feedback too.
        """
        found = None
        for axis, motor, load, demand in zip(
            self.axes, feedback.motor_position, feedback.load_position, feedback.velocity_demand, strict=True
        ):
            if 0.0 < since <= self._hole:
                found = axis.check(motor, load, demand * since, demand) or found
            else:
                axis.begin(motor, load)
        return found
