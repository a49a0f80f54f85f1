"""The motor driver on topics: SYNC at every tick, encoders and demand out, `servo_jv` in; see `motor_driver`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rclpy.node import Node
from sher3_description import Robot
from sher3_description.reasons import Action, Reason
from sher3_runtime import (
    NODE_OPTIONS,
    DiagnosticSample,
    JointSample,
    advertise,
    advertise_on_demand,
    clock_of,
    latest,
    on_tick,
    statistics_of,
    subscribe,
)

from .bus import CanLink, open_links
from .driver_report import driver_report
from .errors import CommandRefused, DriverError
from .feedback import Feedback
from .motor_driver import MotorDriver
from .settings import MotorDriverSettings, default_settings
from .trips import Trip

REPORT_PERIOD = 0.1
STATES = ("DISABLED", "ENABLED", "PAUSED", "FAULT")


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
        self._state, self._action = "DISABLED", Action.NONE
        self._told = False
        self._refused: str | None = None
        self._publish_position = advertise(self, "measured_js")
        self._publish_drives = advertise_on_demand(self, "drives/measured_js")
        self._publish_demand = advertise_on_demand(self, "drives/setpoint_jv")
        self._publish_report = advertise(self, "diagnostics")
        self._sent = statistics_of(self).trace("sent servo_jv")
        subscribe(self, "servo_jv", self._on_command)
        subscribe(self, "operating_state", lambda sample: self._obey(sample.text, Action.QUICK_STOP))
        self._take_heartbeat = latest(self, "supervisor/heartbeat")
        on_tick(self, self._tick)
        on_tick(self, self._report, 0.5 * settings.period, max(1, round(REPORT_PERIOD / settings.period)))

    def _tick(self, stamp: int) -> None:
        driver = self.driver
        if (beat := self._take_heartbeat()) is not None:
            self._on_heartbeat(beat.text)
        driver.tick(stamp)
        position = driver.collect_positions()
        if position is not None:
            self._publish_position(JointSample(stamp, position))
        feedback = driver.collect()
        if feedback is not None:
            self._publish_feedback(stamp, feedback)
        if self._told is not (driver.stop.first is not None):
            self._report(stamp)

    def _publish_feedback(self, stamp: int, feedback: Feedback) -> None:
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
        except CommandRefused as error:
            self._note(f"servo_jv: {error}")

    def _on_heartbeat(self, text: str) -> None:
        """Take a heartbeat of the supervisor, `STATE ACTION`; a damaged one is none."""
        state, _, action = text.partition(" ")
        if state in STATES and action in Action.__members__:
            self.driver.hear_supervisor()
            self._obey(state, Action[action])

    def _obey(self, state: str, action: Action) -> None:
        """Follow the supervisor; leaving FAULT for DISABLED is its one-shot recovery, which resets the drives."""
        harder = state == "FAULT" and action > self._action
        if state == self._state and not harder:
            return
        self._state, self._action = state, action if state == "FAULT" else Action.NONE
        try:
            self._follow(state, action)
        except CommandRefused as error:
            self._note(str(error))

    def _follow(self, state: str, action: Action) -> None:
        driver = self.driver
        if state in ("ENABLED", "PAUSED"):
            driver.enable()
        elif state == "DISABLED" and driver.needs_reset:
            driver.reset()
        elif state == "DISABLED":
            driver.disable()
        else:
            driver.stop_for(Trip(Reason.SUPERVISOR_FAULT, f"operating state {state}"), action)

    def _note(self, refusal: str) -> None:
        """Log a refusal once; the driver counts the rest."""
        if self._refused is None:
            self.get_logger().error(refusal)
        self._refused = refusal

    def _report(self, stamp: int) -> None:
        self._told = self.driver.stop.first is not None
        level, message, values = driver_report(self.driver, self._refused)
        self._publish_report(DiagnosticSample(stamp, "motor_driver: drives", level, message, values))

    def close(self) -> None:
        """Brake, take the power off and leave the bus."""
        self.driver.close()
