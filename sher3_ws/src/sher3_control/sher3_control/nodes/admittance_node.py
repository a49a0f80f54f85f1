"""The admittance node: wrench, pedal and joint positions in, `servo_cv` out; all decisions are in `sher3_control.law`.

A tick runs as soon as its wrench has come, and its pedal sample too where the pedal keeps the rate of the host. When
they have not come `LATE` of a period after the stamp, it runs with what there is.
"""

from __future__ import annotations

import json
from typing import Any, cast

import numpy as np
from rclpy.node import Node
from sher3_common import Sher3Error
from sher3_common.compiled import direct
from sher3_common.reasons import TEXT, Reason
from sher3_common.samples import DiagnosticSample, JointSample, JoySample, TextSample, TwistSample, WrenchSample
from sher3_common.stamps import NO_STAMP, nanoseconds
from sher3_common.vectors import Wrench
from sher3_description import ACTUATORS, Robot
from sher3_kinematics import RobotKinematics
from sher3_kinematics.kernel import kernel_parameters
from sher3_runtime.on_demand import advertise_on_demand
from sher3_runtime.ports import NODE_OPTIONS, advertise, clock_of, gathered, latest, on_tick, subscribe
from std_srvs.srv import Trigger

from sher3_control.law.admittance import NO_WRENCH, LawInput, initial_state, step
from sher3_control.law.angles import roll_and_tilt
from sher3_control.law.live_parameters import apply_command, live_parameters, to_json, with_bias
from sher3_control.law.parameters import law_parameters
from sher3_control.law.pedal import pedal_reading
from sher3_control.law.tare import DriftMonitor, TareWindow
from sher3_control.motion.ownership import Mode
from sher3_control.nodes.heard import HeardState, status_of
from sher3_control.nodes.input_report import felt, law_readings
from sher3_control.settings import ControlSettings
from sher3_control.supervision.pull import Pull
from sher3_control.tick_records import AdmittanceRecord, record_text

LATE = 0.7
"""Fraction of the period after which a tick no longer waits for its samples."""
ROLL, TILT = ACTUATORS.index("roll"), ACTUATORS.index("tilt")


class AdmittanceNode(Node):
    """Cooperative law, live parameters, tare.

    Attributes:
        settings: of all control nodes.
        heard: the operating state as this node knows it.
        owns: the cooperative mode owns the robot, or nobody does.
        live: parameters in force.
    """

    def __init__(self, robot: Robot, settings: ControlSettings | None = None, **options: Any) -> None:
        """Make the node with its doors; it computes at the first tick.

        Args:
            robot: the robot; its `control_period` is the rate of the ticks.
            settings: of all control nodes, by default those of the robot.
            options: of `rclpy.node.Node`.
        """
        super().__init__("admittance", **{**NODE_OPTIONS, **options})
        self.settings = ControlSettings.from_robot(robot) if settings is None else settings
        self._p = law_parameters(robot, self.settings)
        self._kernel = np.array(kernel_parameters(robot))
        self._state = initial_state()
        self.live = live_parameters(self.settings)
        self._wrench: tuple[int, Wrench] = (NO_STAMP, NO_WRENCH)
        self._pedal: tuple[int, float, bool] = (NO_STAMP, 0.0, False)
        self._joints: tuple[int, tuple[float, ...], float, float] = (NO_STAMP, (), 0.0, 0.0)
        self.heard = HeardState(self.settings.supervisor.heartbeat_limit)
        self.owns = False
        self._tick_count, self._last, self._since = 0, -1, -1
        self._reason: Reason | None = None
        self._window = TareWindow(robot, self.settings.tare)
        self._drift = DriftMonitor(self.settings.tare, robot.control_period)
        self._pull = Pull(RobotKinematics(robot), self.settings)
        self._events: dict[str, Any] = {}
        # Compiled now, for the types of every tick, and not in the first tick.
        self._roll_and_tilt = direct(roll_and_tilt, self._kernel, 0.0, 0.0)
        self._step = direct(step, self._state, self._input(0), self._p)

        # A tick hears its streams in the order of these subscriptions.
        self._publish_twist = advertise(self, "servo_cv")
        self._publish_inputs = advertise_on_demand(self, "admittance/inputs")
        self._publish_settings = advertise(self, "admittance/settings")
        self._publish_status = advertise(self, "admittance/status")
        self._take_joints = latest(self, "measured_js")
        self._pedal_topic = subscribe(self, "pedal/measured", self.on_pedal)
        subscribe(self, "force/measured_cf", self.on_wrench)
        subscribe(self, "operating_state", self.on_state)
        self._take_heartbeat = latest(self, "supervisor/heartbeat")
        self._take_drives = gathered(self, "drives/measured_js", self.settings.tare.samples)
        subscribe(self, "motion/status", self.on_motion)
        subscribe(self, "command/admittance", self._on_command)
        self.create_service(Trigger, "admittance/tare", self._on_tare)
        self._now = clock_of(self).now
        period = robot.control_period
        self._late = on_tick(self, self._tick, phase=LATE * period)
        every = max(1, round(self.settings.supervisor.publish_period / period))
        on_tick(self, self._tell, phase=LATE * period, every=every)
        self._publish_diagnostics = advertise(self, "diagnostics")
        self._publish_settings(TextSample(to_json(self.live, self.settings)))

    def on_joints(self, sample: JointSample) -> None:
        """Take the positions of the load encoders, if the sample has all five."""
        if (q := sample.position) is not None and len(q) == len(ACTUATORS):
            self._joints = (sample.stamp, q, *self._roll_and_tilt(self._kernel, q[ROLL], q[TILT]))

    def on_pedal(self, sample: JoySample) -> None:
        """Take the pedal's sample, and run the tick where its wrench has come before it."""
        self._pedal = (sample.stamp, *pedal_reading(sample.axes, sample.buttons))
        if sample.stamp == self._wrench[0]:
            self._tick(sample.stamp)

    def on_wrench(self, sample: WrenchSample) -> None:
        """Take the wrench, and run the tick unless the pedal's sample of the same tick is about to come."""
        self._wrench = (sample.stamp, cast(Wrench, sample.wrench))
        if self._pedal[0] != sample.stamp - self._p.period:
            self._tick(sample.stamp)
        else:
            self._pedal_topic.wakes = True

    def on_state(self, sample: TextSample) -> None:
        """Take an operating state or a heartbeat of the supervisor."""
        self.heard.feed(sample.text, self._now())

    def on_motion(self, sample: TextSample) -> None:
        """Take the status of the motion modes: who owns the robot."""
        self.owns = status_of(sample.text).get("mode", "unknown") in (None, Mode.COOPERATIVE.value)

    def _tick(self, stamp: int) -> None:
        if stamp <= self._last:
            return
        self._last = stamp
        self._late.done(stamp)
        self._pedal_topic.wakes = False  # in most ticks the pedal's sample has come before the wrench
        if (joints := self._take_joints()) is not None:
            self.on_joints(joints)
        if (beat := self._take_heartbeat()) is not None:
            self.on_state(beat)
        law_input = self._input(stamp)
        self._state, output = self._step(self._state, law_input, self._p)
        if law_input.owner:
            self._publish_twist(TwistSample(stamp, output.twist))
        self._record(law_input)
        joints = self._joints
        self._window.feed(law_input.wrench_stamp, law_input.wrench, joints[1], joints[2], joints[3])
        if output.reason is Reason.PEDAL_RELEASED:
            self._drift.feed(output.wrench)
        if output.reason is not self._reason:
            self._reason, self._since = output.reason, stamp
            self._drift.reset()
            self._report()

    def _input(self, stamp: int) -> LawInput:
        live, pedal, joints, wrench = self.live, self._pedal, self._joints, self._wrench
        return LawInput(
            stamp, self.heard.enabled(stamp), self.owns, wrench[0], wrench[1], pedal[0], pedal[1], pedal[2],
            joints[0], joints[2], joints[3],
            live.speed_scale, live.linear_gain, live.angular_gain, int(live.lock), live.bias,
        )  # fmt: skip

    def _record(self, i: LawInput) -> None:
        if self._publish_inputs.wanted():
            stamps = (i.stamp, i.wrench_stamp, i.pedal_stamp, i.joints_stamp)
            record = AdmittanceRecord(self._tick_count, *stamps, int(i.enabled), int(i.owner), self.live.version)
            self._publish_inputs(TextSample(record_text(record)))
        self._tick_count += 1

    def _on_command(self, sample: TextSample) -> None:
        try:
            self.live = apply_command(self.live, sample.text, self.settings)
        except Sher3Error as error:
            self._report(refused={**error.to_dict(), "text": str(error)})
            return
        self._publish_settings(TextSample(to_json(self.live, self.settings)))
        self._events.pop("refused", None)
        self._report(parameters=self.live._asdict())

    def _on_tare(self, _request: Any, response: Any) -> Any:
        try:
            pressed = self._pedal[1] > self.settings.pedal.release
            limit = nanoseconds(self.settings.wrench.age_limit)
            now = self._now()
            self._pull.hear(self._take_drives())
            result = self._window.tare(pressed, now, limit, self.live.bias)
            if self.heard.enabled(now) and self.settings.motion.regime != "bench":
                self._pull.require_none()
        except Sher3Error as error:
            response.success, response.message = False, str(error)
            self._report(refused={**error.to_dict(), "text": str(error)})
            return response
        self.live = with_bias(self.live, result.bias)
        self._drift.reset()
        self._publish_settings(TextSample(to_json(self.live, self.settings)))
        self._events.pop("refused", None)
        self._report(tare=vars(result))
        response.success, response.message = True, json.dumps(vars(result))
        return response

    def _tell(self, stamp: int) -> None:
        """Publish status and the numbers behind it, once a second."""
        self._report()
        reason = Reason.NOT_ENABLED if self._reason is None else self._reason
        values = (felt(self._wrench[1], self.live.bias), *law_readings(self._input(stamp), self._state, self._p))
        self._publish_diagnostics(DiagnosticSample(stamp, "admittance: inputs", 0, reason.name, values))

    def _report(self, **event: Any) -> None:
        """Publish the status; an event stays in it until the next one of its kind."""
        self._events.update(event)
        reason = Reason.NOT_ENABLED if self._reason is None else self._reason
        drift = {"drift": self._drift.drift, "drift_exceeded": self._drift.exceeded()}
        status = {"reason": reason.name, "text": TEXT[reason], "since": self._since, **drift, **self._events}
        self._publish_status(TextSample(json.dumps(status, default=str)))
