"""The supervisor node: streams and state commands in, `operating_state` out, latched and repeated; see `supervisor`."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from rclpy.node import Node
from sher3_description import Robot, Sher3Error
from sher3_runtime import DiagnosticSample, JoySample, TextSample
from sher3_runtime.ports import NODE_OPTIONS, advertise, clock_of, latest, on_tick, subscribe

from .detectors import Detector, EmergencyStopDetector, ReportedFault, SilenceDetector
from .settings import ControlSettings
from .supervisor import Supervisor

WATCHED = ("force/measured_cf", "measured_js", "servo_jv")
DRIVES = "motor_driver: drives"
"""The diagnostic whose error level says that the driver has stopped by itself."""
ERROR = 2
CHECK_PERIOD = 0.01
"""Period at which silence is looked for [s]; the emergency stop is judged when its sample arrives."""


class SupervisorNode(Node):
    """Owner of the operating state."""

    def __init__(
        self,
        robot: Robot,
        settings: ControlSettings | None = None,
        detectors: Sequence[Detector] = (),
        **options: Any,
    ) -> None:
        """Take the robot, settings (default: those of the robot) and further detectors beside the built-in ones."""
        super().__init__("supervisor", **{**NODE_OPTIONS, **options})
        self.settings = (ControlSettings.from_robot(robot) if settings is None else settings).supervisor
        self._silence = {s: SilenceDetector(s, self.settings.stream_age_limit) for s in (*WATCHED, "pedal/measured")}
        self._button = EmergencyStopDetector()
        self._drives = ReportedFault("motor_driver")
        self.supervisor = Supervisor([self._button, self._drives, *self._silence.values(), *detectors])
        self._refused: dict[str, Any] | None = None
        self._publish_state = advertise(self, "operating_state")
        self._publish_status = advertise(self, "supervisor/status")
        self._watched = [(self._silence[name], latest(self, name)) for name in WATCHED]
        subscribe(self, "pedal/measured", self._on_pedal)
        subscribe(self, "diagnostics", self._on_diagnostics)
        subscribe(self, "command/state_command", self._on_command)
        self._now = clock_of(self).now
        period = robot.control_period
        on_tick(self, self._check, phase=0.5 * period, every=max(1, round(CHECK_PERIOD / period)))
        on_tick(self, self._repeat, phase=0.5 * period, every=max(1, round(self.settings.publish_period / period)))
        self._publish()

    def _look(self) -> None:
        """Note the newest sample of each watched stream; waking up for all of them would cost more than the rest."""
        for detector, take in self._watched:
            if (sample := take()) is not None:
                detector.last = sample.stamp

    def _on_pedal(self, sample: JoySample) -> None:
        self._silence["pedal/measured"].last = sample.stamp
        pressed = bool(sample.buttons[0]) if sample.buttons else True
        if pressed != self._button.pressed:
            self._button.feed(pressed)
            self._check(self._now())

    def _on_diagnostics(self, sample: DiagnosticSample) -> None:
        if sample.name == DRIVES:
            self._drives.feed(sample.level >= ERROR, sample.message, self._now())
            self._check(self._now())

    def _check(self, _now: int) -> None:
        self._look()
        if self.supervisor.check(self._now()):
            self._publish()

    def _on_command(self, sample: TextSample) -> None:
        self._look()
        try:
            self.supervisor.command(sample.text, self._now())
            self._refused = None
        except Sher3Error as error:
            self._refused = {"command": sample.text, "error": type(error).__name__, "text": str(error)}
        self._publish()

    def _repeat(self, _stamp: int) -> None:
        self._publish()

    def _publish(self) -> None:
        status = self.supervisor.status
        self._publish_state(TextSample(status.state.value))
        self._publish_status(TextSample(json.dumps({**json.loads(status.to_json()), "refused": self._refused})))
