"""The motor driver on topics: SYNC at every tick, encoders and demand out, `servo_jv` in; see `motor_driver`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rclpy.node import Node
from sher3_common.samples import DiagnosticSample, JointSample
from sher3_common.stamps import SECOND
from sher3_common.vectors import Vector
from sher3_description import Robot
from sher3_runtime import (
    NODE_OPTIONS,
    advertise,
    advertise_on_demand,
    clock_of,
    latest,
    on_tick,
    statistics_of,
    subscribe,
)

from sher3_drivers.bus.link import CanLink, open_links
from sher3_drivers.canopen.tpdo import DriveFeedback
from sher3_drivers.drive.motor_driver import MotorDriver
from sher3_drivers.drive.report import driver_report
from sher3_drivers.drive.supervisor_link import SupervisorLink
from sher3_drivers.errors import CommandRefused, DriverError
from sher3_drivers.settings import MotorDriverSettings, default_settings

REPORT_PERIOD = 0.1
"""Time between two diagnostics while nothing happens, s; a stop is reported at once."""


class MotorDriverNode(Node):
    """The last gate before the drives. It follows `operating_state` and stops by itself when anything is wrong.

    Args:
        robot: the robot.
        settings: channels and limits; by default the local links of the robot's control period.
        links: opened links instead of those the settings name (stepped tests).
        patience: longest wait for the drives at the start, s.

    Raises:
        LinkError, OtherHost, DriveSilent, DriveMismatch: the drives cannot be reached or are not what they must be.
    """

    def __init__(
        self,
        robot: Robot,
        settings: MotorDriverSettings | None = None,
        links: Sequence[CanLink] | None = None,
        patience: float = 10.0,
        **options: Any,
    ) -> None:
        super().__init__("motor_driver", **{**NODE_OPTIONS, **options})
        settings = settings or default_settings(robot.control_period)
        if links is None:
            links = open_links([channel.link for channel in settings.channels])
        self.driver = MotorDriver(robot, settings, links, clock_of(self).now)
        try:
            self.driver.configure(patience)
        except DriverError:
            for link in links:
                link.close()
            raise
        self._supervisor = SupervisorLink(self.driver)
        self._reported_stop = False
        self._refused: str | None = None
        self._logged = False
        self._before: tuple[int, Vector] | None = None
        self._publish_position = advertise(self, "measured_js")
        self._publish_drives = advertise_on_demand(self, "drives/measured_js")
        self._publish_demand = advertise_on_demand(self, "drives/setpoint_jv")
        self._publish_report = advertise(self, "diagnostics")
        self._sent = statistics_of(self).trace("sent servo_jv")
        subscribe(self, "servo_jv", self._on_command)
        subscribe(self, "operating_state", lambda sample: self._supervisor.obey(sample.text))
        subscribe(self, "motion/settings", lambda sample: self.driver.hear_regime(sample.text))
        self._take_heartbeat = latest(self, "supervisor/heartbeat")
        on_tick(self, self._tick)
        on_tick(self, self._report, 0.5 * settings.period, max(1, round(REPORT_PERIOD / settings.period)))

    def _tick(self, stamp: int) -> None:
        driver = self.driver
        if (beat := self._take_heartbeat()) is not None:
            self._supervisor.hear(beat.text)
        driver.tick(stamp)
        position = driver.collect_positions()
        if position is not None:
            self._publish_position(JointSample(stamp, position, self._velocity(stamp, position)))
        feedback = driver.collect()
        if feedback is not None:
            self._publish_feedback(stamp, feedback)
        if self._reported_stop is not (driver.stop.first is not None):
            self._report(stamp)

    def _velocity(self, stamp: int, position: Vector) -> Vector:
        """Return the difference to the reading before over the time between them, m/s and rad/s; 0 at the first."""
        (before, there), self._before = self._before or (stamp, position), (stamp, position)
        rate = SECOND / (stamp - before) if stamp > before else 0.0
        return tuple([rate * (here - then) for here, then in zip(position, there, strict=True)])

    def _publish_feedback(self, stamp: int, feedback: DriveFeedback) -> None:
        if self._publish_drives.wanted():
            sample = JointSample(stamp, feedback.motor_position, feedback.motor_velocity, feedback.effort)
            self._publish_drives(sample)
        if self._publish_demand.wanted():
            self._publish_demand(JointSample(stamp, None, feedback.velocity_demand))

    def _on_command(self, sample: JointSample) -> None:
        try:
            sent = self.driver.command(sample.stamp, sample.velocity or ())
            if sent and self._sent is not None:
                self._sent.mark(sample.stamp, self.driver.clock())
            self._refused = None
        except CommandRefused as error:
            self._refused = f"servo_jv: {error}"

    def _refusal(self) -> str | None:
        """Return what is refused now, None once its cause is gone; the first one ever is logged, all are counted."""
        refusal = self._supervisor.refused or self._refused
        if refusal is not None and not self._logged:
            self._logged = True
            self.get_logger().error(refusal)
        return refusal

    def _report(self, stamp: int) -> None:
        self._reported_stop = self.driver.stop.first is not None
        level, message, values = driver_report(self.driver, self._refusal())
        self._publish_report(DiagnosticSample(stamp, "motor_driver: drives", level, message, values))

    def close(self) -> None:
        """Brake, take the power off and leave the bus."""
        self.driver.close()
