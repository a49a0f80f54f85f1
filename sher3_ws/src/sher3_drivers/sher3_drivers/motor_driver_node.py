"""The motor driver on topics: SYNC at every tick, encoders and demand out, `servo_jv` in; see `motor_driver`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rclpy.node import Node
from sher3_description import Robot
from sher3_runtime import (
    NODE_OPTIONS,
    DiagnosticSample,
    JointSample,
    TextSample,
    advertise,
    clock_of,
    on_tick,
    subscribe,
)

from .bus import CanLink, open_link
from .driver_report import driver_report
from .errors import CommandRefused
from .motor_driver import MotorDriver
from .settings import MotorDriverSettings, default_settings

REPORT_PERIOD = 0.1


class MotorDriverNode(Node):
    """The last gate before the drives. It follows `operating_state` and stops by itself when anything is wrong.

    Args:
        robot: the robot.
        settings: channels and limits; by default the local links of the robot's control period.
        links: opened links instead of those the settings name (stepped tests).
        patience: longest wait for the drives at the start, s.

    Raises:
        LinkError, DriveSilent, DriveMismatch: the drives cannot be reached or are not what they must be.
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
            links = [open_link(channel.link) for channel in settings.channels]
        self.driver = MotorDriver(robot, settings, links, clock_of(self).now)
        self.driver.configure(patience)
        self._state = "DISABLED"
        self._refused: str | None = None
        self._publish_position = advertise(self, "measured_js")
        self._publish_drives = advertise(self, "drives/measured_js")
        self._publish_demand = advertise(self, "drives/setpoint_jv")
        self._publish_report = advertise(self, "diagnostics")
        subscribe(self, "servo_jv", self._on_command)
        subscribe(self, "operating_state", self._on_state)
        on_tick(self, self._tick)
        on_tick(self, self._report, 0.5 * settings.period, max(1, round(REPORT_PERIOD / settings.period)))

    def _tick(self, stamp: int) -> None:
        driver = self.driver
        driver.tick(stamp)
        position = driver.collect_positions()
        if position is not None:
            self._publish_position(JointSample(stamp, position))
        feedback = driver.collect()
        if feedback is not None:
            sample = JointSample(stamp, feedback.motor_position, feedback.motor_velocity, feedback.effort)
            self._publish_drives(sample)
            self._publish_demand(JointSample(stamp, None, feedback.velocity_demand))

    def _on_command(self, sample: JointSample) -> None:
        try:
            self.driver.command(sample.stamp, sample.velocity or ())
        except CommandRefused as error:
            self._note(f"servo_jv: {error}")

    def _on_state(self, sample: TextSample) -> None:
        """Follow the supervisor; leaving FAULT for DISABLED is its one-shot recovery, which resets the drives."""
        if sample.text == self._state:
            return
        self._state = sample.text
        try:
            self._follow(sample.text)
        except CommandRefused as error:
            self._note(str(error))

    def _follow(self, state: str) -> None:
        driver = self.driver
        if state in ("ENABLED", "PAUSED"):
            driver.enable()
        elif state == "DISABLED" and driver.needs_reset:
            driver.reset()
        elif state == "DISABLED":
            driver.disable()
        else:
            driver.quick_stop(f"operating state {state}")

    def _note(self, refusal: str) -> None:
        """Log a refusal once; the driver counts the rest."""
        if self._refused is None:
            self.get_logger().error(refusal)
        self._refused = refusal

    def _report(self, stamp: int) -> None:
        level, message, values = driver_report(self.driver, self._refused)
        self._publish_report(DiagnosticSample(stamp, "motor_driver: drives", level, message, values))

    def close(self) -> None:
        """Brake, take the power off and leave the bus."""
        self.driver.close()
