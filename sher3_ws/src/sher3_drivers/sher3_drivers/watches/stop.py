"""Everything that may stop the robot, in one place: timing, bus, drives and motion."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.bus import BusWatch
from sher3_drivers.watches.drives import DriveHealth, DrivesWatch
from sher3_drivers.watches.loop import LoopWatch
from sher3_drivers.watches.motion import MotionWatch


class StopWatches:
    """The watches of the motor driver.

    Attributes:
        loop: timing of the loop that calls the driver, and the age of the supervisor's heartbeat.
        bus: what controllers and drives say by themselves: error frames, heartbeats, emergency messages.
        drives: drives that fall silent or get stuck.
        motion: whether encoders and demand of every axis agree, and whether a stopped robot rests.
    """

    def __init__(
        self, health: Sequence[DriveHealth], scales: Sequence[AxisScale], settings: MotorDriverSettings
    ) -> None:
        self.loop = LoopWatch(settings)
        self.bus = BusWatch(health, settings)
        self.drives = DrivesWatch(health, settings)
        self.motion = MotionWatch(scales, settings)
