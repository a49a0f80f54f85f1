"""The supervisor node: streams and state commands in, `operating_state` out, latched and repeated.

All decisions are in `sher3_control.supervision`. The tick that asks the detectors also sends the heartbeat, so a
supervisor that hangs falls silent, and everybody stops.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from itertools import cycle
from typing import Any

import numpy as np
from rclpy.node import Node
from sher3_common import Sher3Error
from sher3_common.operating_state import OperatingState
from sher3_common.reasons import Reason, reading
from sher3_common.samples import DiagnosticSample, JointSample, JoySample, PoseSample, TextSample
from sher3_common.stamps import NO_STAMP
from sher3_common.vectors import Vector
from sher3_description import ACTUATORS, Robot
from sher3_kinematics import RobotKinematics
from sher3_runtime.ports import NODE_OPTIONS, advertise, by_ring, clock_of, gathered, latest, on_tick, ports, subscribe
from sher3_runtime.publishers import Publishers

from sher3_control.law.pedal import pedal_reading
from sher3_control.nodes.same_tick import SameTick
from sher3_control.settings import ControlSettings
from sher3_control.supervision.detectors import (
    Detector,
    EmergencyStopDetector,
    OverrunDetector,
    PedalFormDetector,
    ReportedFault,
    SilenceDetector,
    TwinDetector,
)
from sher3_control.supervision.driver_reports import DRIVES, LOOP, cycle_counts, driver_stop
from sher3_control.supervision.hand import HandDetector
from sher3_control.supervision.leg_residual import LegDetector, leg_residual
from sher3_control.supervision.supervisor import Supervisor
from sher3_control.supervision.zero import ToolContact, ZeroDetector

PEDAL, COMMAND = "pedal/measured", "servo_jv"
STREAMS = {
    "force/measured_cf": (Reason.WRENCH_MISSING, Reason.WRENCH_STALE),
    "measured_js": (Reason.JOINTS_MISSING, Reason.JOINTS_STALE),
    COMMAND: (Reason.COMMAND_MISSING, Reason.COMMAND_STALE),
    PEDAL: (Reason.PEDAL_MISSING, Reason.PEDAL_STALE),
}
"""Watched streams, each with the reason when no sample ever came and when it fell silent."""
OWN_STATE = "operating_state"
TIP = "tracker/measured_cp"
SAID = ("motion/settings", "motion/status", "admittance/settings", "admittance/status")
"""What the control nodes say and others obey: the regime with its caps, who owns the robot, the bias of the tare."""
TARE = "admittance/settings"
STEERING = ("servo_cv",)
BESIDE = ("drives/measured_js", "drives/setpoint_jv", "supervisor/heartbeat")
OWN = (*STREAMS, OWN_STATE, *SAID, TIP, *STEERING, *BESIDE)
"""Topics that only the robot itself publishes: those that are watched, those that steer it, and the others."""
FELT = ("force/measured_cf", "measured_js", "drives/measured_js", COMMAND)
"""Streams that tell of a hand; all that is watched but the pedal is among them."""
TOUCHED = FELT[:2]
"""Those that tell what touches the tool, whether the drives have power or not."""
DEPTH = 32
"""Samples of each that wait for the next look: 32 ms of the fastest robot."""
POWERED = (OperatingState.ENABLED, OperatingState.PAUSED)
"""States in which the drives hold what pushes on the tip."""
LEVELS = {OperatingState.FAULT: 2, OperatingState.PAUSED: 1}
"""Level of the supervisor's diagnostic by operating state: 2 error, 1 warning; 0, the others, is ok."""


class SupervisorNode(Node):
    """Owner of the operating state.

    Attributes:
        settings: what is watched, and against which limits.
        supervisor: the state machine with its detectors.
    """

    def __init__(
        self,
        robot: Robot,
        settings: ControlSettings | None = None,
        detectors: Sequence[Detector] = (),
        **options: Any,
    ) -> None:
        """Make the node with its doors, in DISABLED.

        Args:
            robot: the robot; its `control_period` is the rate of the ticks.
            settings: of all control nodes, by default those of the robot.
            detectors: further detectors beside the built-in ones.
            options: of `rclpy.node.Node`.
        """
        super().__init__("supervisor", **{**NODE_OPTIONS, **options})
        settings = ControlSettings.from_robot(robot) if settings is None else settings
        self.settings = settings.supervisor
        limit = self.settings.stream_age_limit
        self._silence = {name: SilenceDetector(name, limit, *reasons) for name, reasons in STREAMS.items()}
        self._button, self._form = EmergencyStopDetector(), PedalFormDetector()
        self._drives = ReportedFault("motor_driver")
        self._overruns = OverrunDetector(self.settings.overrun_share)
        kinematics = _warm(RobotKinematics(robot))
        self._leg, self._twins = LegDetector(kinematics, self.settings), TwinDetector()
        self._contact = ToolContact(robot)
        self._hand = None if settings.motion.regime == "bench" else HandDetector(kinematics, settings)
        self._zero = ZeroDetector(settings.tare)
        built_in = [
            self._button,
            self._form,
            self._drives,
            *self._silence.values(),
            self._overruns,
            self._leg,
            self._twins,
        ]
        hands = [] if self._hand is None else [self._hand, self._zero]
        self.supervisor = Supervisor([*built_in, *hands, *detectors])
        self._refused: dict[str, Any] | None = None
        self._beat = TextSample(self.supervisor.status.heartbeat)
        self._joints = JointSample(NO_STAMP)

        self._publish_state = advertise(self, OWN_STATE)
        self._publish_status = advertise(self, "supervisor/status")
        self._publish_heartbeat = advertise(self, "supervisor/heartbeat")
        self._publish_error = advertise(self, "error")
        self._publish_report = advertise(self, "diagnostics")
        self._ticks, self._touched = SameTick(*FELT), SameTick(*TOUCHED)
        heard = FELT if self._hand is not None else [name for name in FELT if name in STREAMS]
        self._felt = [(name, gathered(self, name, DEPTH)) for name in heard]
        self._command: Vector = (0.0,) * len(ACTUATORS)
        self._moved = NO_STAMP
        self._take_tip = latest(self, TIP)
        subscribe(self, PEDAL, self.on_pedal)
        self._take_pedal = by_ring(self, PEDAL, DEPTH)
        # But for the tare's never taken: they are there to know their publishers, and only those of our type.
        self._take_tare = {name: latest(self, name) for name in (OWN_STATE, *SAID)}[TARE]
        watched = (*STREAMS, OWN_STATE, *SAID, TIP)
        self._matched = [(name, ports(self).subscriptions[name].handle.get_publisher_count) for name in watched]
        self._living = Publishers(self)
        self._in_turn = cycle(BESIDE)
        subscribe(self, "diagnostics", self._on_diagnostics)
        subscribe(self, "command/state_command", self._on_command)
        self._now = clock_of(self).now
        period = robot.control_period
        on_tick(self, self.check, phase=0.5 * period, every=max(1, round(self.settings.heartbeat_period / period)))
        on_tick(self, self._repeat, phase=0.5 * period, every=max(1, round(self.settings.publish_period / period)))
        self._publish()

    def _look(self) -> None:
        """Note what came on the watched streams; to wake up for every sample would cost more than the rest."""
        for sample in self._take_pedal():
            self._note_pedal(sample)
        for name, take in self._felt:
            for sample in take():
                if name in self._silence:
                    self._silence[name].last = sample.stamp
                if name == "measured_js":
                    self._joints = sample
                elif name == COMMAND and any(sample.velocity or ()):
                    self._moved = sample.stamp
                if self._hand is not None:
                    self._ticks.put(name, sample)
                if self._hand is not None and name in TOUCHED:
                    self._touched.put(name, sample)

    def _look_at_leg(self) -> None:
        """Compare the newest sample of the tracker with that of the axes where both are of one tick."""
        tip: PoseSample | None = self._take_tip()
        if tip is not None and tip.stamp == self._joints.stamp and self._joints.position is not None:
            self._leg.feed(tip.stamp, tip.position, self._joints.position)

    def _look_at_hand(self) -> None:
        """Compare what force sensor and drives felt in each tick since the last look."""
        if self._hand is None:
            return
        if (said := self._take_tare()) is not None:
            self._contact.hear(said.text)
        powered, resting = self.supervisor.state in POWERED, self.supervisor.state is OperatingState.DISABLED
        if not powered:
            self._hand.begin()
            self._moved = NO_STAMP
        touched = self._touched.take()
        if resting:
            at_tip = self._contact.at_tip
            self._zero.rest((w.stamp, at_tip(w.wrench, j.position)) for w, j in touched if j.position is not None)
        else:
            self._zero.begin()
        for wrench, joints, forces, command in self._ticks.take():
            if powered and joints.position is not None and forces.effort is not None:
                contact = self._contact.at_tip(wrench.wrench, joints.position)
                self._hand.feed(wrench.stamp, contact, joints.position, forces.effort, self._command)
            self._command = command.velocity or self._command
        if powered and self._moved != NO_STAMP:
            self._hand.move(self._moved)

    def _count_publishers(self, *beside: str) -> None:
        """Count the living publishers of the streams that move the robot, and of the streams `beside`.

        A subscription knows its publishers. Where there is no subscription the graph is asked, which costs twenty times
        as much.
        """
        count, now = self._living.count, self._now()
        counts = {name: count(name, now, known) for name, known in self._matched}
        counts.update((name, count(name, now)) for name in (*STEERING, *beside))
        self._twins.feed(counts)

    def on_pedal(self, sample: JoySample) -> None:
        """Take the pedal's sample; a change of the emergency stop is judged at once."""
        if self._note_pedal(sample):
            self._judge()

    def _note_pedal(self, sample: JoySample) -> bool:
        """Note a sample of the pedal; return whether its emergency stop or its form has changed."""
        self._silence[PEDAL].last = sample.stamp
        _, pressed = pedal_reading(sample.axes, sample.buttons)
        before = self._button.pressed, self._form.axes, self._form.buttons
        self._button.feed(pressed)
        self._form.feed(len(sample.axes), len(sample.buttons))
        return before != (self._button.pressed, self._form.axes, self._form.buttons)

    def _on_diagnostics(self, sample: DiagnosticSample) -> None:
        if sample.name == DRIVES:
            self._drives.feed(driver_stop(sample.level, sample.message, sample.values), self._now())
            self._judge()
        elif sample.name in LOOP and (counts := cycle_counts(sample.values)) is not None:
            self._overruns.feed(sample.name, *counts, self._now())

    def _judge(self) -> None:
        self._look()
        if self.supervisor.check(self._now()):
            self._publish()
            self._publish_heartbeat(self._beat)

    def check(self, _stamp: int) -> None:
        """Count publishers, ask the detectors and send the heartbeat."""
        self._count_publishers(next(self._in_turn))
        self._look()
        self._look_at_leg()
        self._look_at_hand()
        if self.supervisor.check(self._now()):
            self._publish()
        self._publish_heartbeat(self._beat)

    def _on_command(self, sample: TextSample) -> None:
        self._count_publishers(*BESIDE)
        self._look()
        self._look_at_hand()
        try:
            self.supervisor.command(sample.text, self._now())
            self._refused = None
        except Sher3Error as error:
            self._refused = {"command": sample.text, "error": type(error).__name__, "text": str(error)}
            self._publish_error(TextSample(str(error)))
        self._publish()
        self._publish_heartbeat(self._beat)

    def _repeat(self, stamp: int) -> None:
        self._publish()
        status, now = self.supervisor.status, self._now()
        looks = [detector.look(now) for detector in self.supervisor.detectors]
        values = [reading(f.reason, f.source, f.value, f.limit, f.unit) for f in looks]
        values += [("reason", status.reason), ("action", status.action.name)]
        values.append(("later_faults", str(status.later_faults)))
        level = LEVELS.get(status.state, 0)
        self._publish_report(DiagnosticSample(stamp, "supervisor: state", level, status.state.value, tuple(values)))

    def _publish(self) -> None:
        status = self.supervisor.status
        self._beat = TextSample(status.heartbeat)
        self._publish_state(TextSample(status.state.value))
        self._publish_status(TextSample(json.dumps({**json.loads(status.to_json()), "refused": self._refused})))


def _warm(kinematics: RobotKinematics) -> RobotKinematics:
    """Return the kinematics, compiled now and not in the first check."""
    leg_residual(kinematics, (0.0,) * 5, np.zeros(3))
    kinematics.transform_tip_to_base(np.zeros(5))
    return kinematics
