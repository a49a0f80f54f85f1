"""The kinematics node: `servo_jv` from the cooperative twist or from a user's command.

All decisions are in `sher3_control.motion`. A cooperative tick runs as soon as `servo_cv` and `measured_js` of its
stamp have come, a tick of another mode as soon as `measured_js` has. When they have not come `LATE` of a period after
the stamp, the tick runs with what there is.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np
from rclpy.node import Node
from sher3_common import Sher3Error
from sher3_common.compiled import direct
from sher3_common.reasons import TEXT, Reason
from sher3_common.samples import DiagnosticSample, JointSample, PoseSample, TextSample, TwistSample, WrenchSample
from sher3_common.stamps import NO_STAMP, nanoseconds
from sher3_common.vectors import ZERO_TWIST
from sher3_description import ACTUATORS, Robot
from sher3_kinematics.kernel import kernel_parameters
from sher3_runtime.on_demand import advertise_on_demand
from sher3_runtime.ports import NODE_OPTIONS, advertise, clock_of, latest, on_tick, subscribe
from sher3_runtime.publishers import Publishers

from sher3_control.errors import CommandRejected
from sher3_control.law.live_parameters import from_json
from sher3_control.motion.controller import MotionController, MotionInput, MotionOutput
from sher3_control.motion.cooperative import RESTING
from sher3_control.motion.deflection import DeflectionCompensation
from sher3_control.motion.ownership import MODE_CODES, Mode
from sher3_control.motion.pose import tip_pose_sample, tip_twist_sample
from sher3_control.motion.rcm_command import apply_rcm_command
from sher3_control.motion.speed_cap import Regime, parse_regime
from sher3_control.nodes.heard import HeardState, status_of
from sher3_control.nodes.input_report import motion_readings
from sher3_control.settings import ControlSettings
from sher3_control.tick_records import MotionRecord, record_text

LATE = 0.85
"""Fraction of the period after which a tick no longer waits for its samples; later than the admittance node's."""
COMMANDS = [mode for mode in Mode if mode is not Mode.COOPERATIVE]
"""Modes that a user commands on a topic of their name."""
GOALS = {Mode.MOVE_JP: "goal_js", Mode.MOVE_CP: "goal_cp"}
"""Topics that tell the newest goal of a mode (CRTK)."""


class KinematicsNode(Node):
    """Motion modes with one owner, the host law, the tip pose.

    Attributes:
        settings: of all control nodes.
        motion: the motion modes.
        heard: the operating state as this node knows it.
    """

    def __init__(self, robot: Robot, settings: ControlSettings | None = None, **options: Any) -> None:
        """Make the node with its doors; it computes at the first tick.

        Args:
            robot: the robot; its `control_period` is the rate of the ticks.
            settings: of all control nodes, by default those of the robot.
            options: of `rclpy.node.Node`.
        """
        super().__init__("kinematics", **{**NODE_OPTIONS, **options})
        self.settings = ControlSettings.from_robot(robot) if settings is None else settings
        wanted = self.settings.motion.deflection_compensation
        self._compensation = DeflectionCompensation(robot, self.settings) if wanted else None
        self.motion = MotionController(robot, self.settings.motion, self._compensation)
        self._kernel = np.array(kernel_parameters(robot))
        self._joints = JointSample(NO_STAMP, RESTING)
        self._twist = TwistSample(NO_STAMP, ZERO_TWIST)
        self.heard = HeardState(self.settings.supervisor.heartbeat_limit)
        self._tick_count, self._last, self._version = 0, -1, 0
        self._shown: tuple[Any, ...] = ()
        self._next_regime: int | None = None
        self._refused: dict[str, Any] | None = None
        # Compiled now, for the types of every tick, and not in the first tick.
        self._tip_pose = direct(tip_pose_sample, self._kernel, RESTING)
        self._tip_twist = direct(tip_twist_sample, self._kernel, RESTING, RESTING)
        self.motion.warm_up()

        # A tick hears its streams in the order of these subscriptions.
        self._publish_velocity = advertise(self, "servo_jv")
        self._publish_setpoint = advertise(self, "setpoint_js")
        self._publish_pose = advertise_on_demand(self, "measured_cp")
        self._publish_twist = advertise_on_demand(self, "measured_cv")
        self._publish_goal = {mode: advertise(self, topic) for mode, topic in GOALS.items()}
        self._publish_inputs = advertise_on_demand(self, "motion/inputs")
        self._publish_settings = advertise(self, "motion/settings")
        self._publish_status = advertise(self, "motion/status")
        self._publish_error = advertise(self, "error")
        self._joints_topic = subscribe(self, "measured_js", self.on_joints)
        subscribe(self, "servo_cv", self.on_twist)
        subscribe(self, "operating_state", self.on_state)
        self._take_heartbeat = latest(self, "supervisor/heartbeat")
        self._living = Publishers(self)
        subscribe(self, "admittance/status", self._on_admittance)
        subscribe(self, "command/rcm", self._on_rcm)
        subscribe(self, "command/regime", self._on_regime)
        if self._compensation is not None:
            subscribe(self, "force/measured_cf", self._on_wrench)
            subscribe(self, "admittance/settings", self._on_tare)
        for mode in COMMANDS:
            subscribe(self, f"command/{mode.value}", self._command(mode), refuse=self._no_command(mode))
        self._now = clock_of(self).now
        period = robot.control_period
        self._late = on_tick(self, self._tick, phase=LATE * period)
        self._publish_diagnostics = advertise(self, "diagnostics")
        every = max(1, round(self.settings.supervisor.publish_period / period))
        on_tick(self, self._tell, phase=LATE * period, every=every)
        self._report_settings()
        self._report(MotionOutput(RESTING, None, Reason.NOT_ENABLED))

    def on_joints(self, sample: JointSample) -> None:
        """Take the load encoders, run the tick unless its twist is still to come, publish the tip's pose and twist."""
        if sample.position is None or len(sample.position) != len(ACTUATORS):
            return
        self._joints = sample
        cooperative = self.motion.ownership.owner in (None, Mode.COOPERATIVE)
        if not cooperative or self._twist.stamp == sample.stamp:
            self._tick(sample.stamp)
        if self._publish_pose.wanted():
            self._publish_pose(PoseSample(sample.stamp, *self._tip_pose(self._kernel, sample.position)))
        if sample.velocity is not None and self._publish_twist.wanted():
            self._publish_twist(
                TwistSample(sample.stamp, self._tip_twist(self._kernel, sample.position, sample.velocity))
            )

    def on_twist(self, sample: TwistSample) -> None:
        """Take the twist of the cooperative law, and run the tick where its positions have come before it."""
        self._twist = sample
        if sample.stamp == self._joints.stamp:
            self._tick(sample.stamp)
        else:
            self._joints_topic.wakes = True

    def _on_wrench(self, sample: WrenchSample) -> None:
        if self._compensation is not None:
            self._compensation.feed(sample.stamp, sample.wrench)

    def _on_tare(self, sample: TextSample) -> None:
        """Take the bias of a tare from the settings in force of the cooperative law."""
        if self._compensation is not None:
            self._compensation.bias = from_json(sample.text)[0].bias

    def on_state(self, sample: TextSample) -> None:
        """Take an operating state or a heartbeat of the supervisor."""
        self.heard.feed(sample.text, self._now())

    def _on_admittance(self, sample: TextSample) -> None:
        wants = status_of(sample.text).get("reason") == Reason.MOVING.name
        now = self._now()
        self.motion.cooperative_wants(wants and self.heard.enabled(now), now)

    def _input(self, stamp: int) -> MotionInput:
        joints, twist = self._joints, self._twist
        if (beat := self._take_heartbeat()) is not None:
            self.on_state(beat)
        enabled = self.heard.enabled(stamp)
        return MotionInput(stamp, enabled, joints.stamp, joints.position or (), twist.stamp, twist.twist)

    def _tick(self, stamp: int) -> None:
        if stamp <= self._last:
            return
        self._last = stamp
        self._late.done(stamp)
        self._begin_regime(stamp)
        # In the cooperative mode the twist comes last, and nothing can be done before it.
        self._joints_topic.wakes = self.motion.ownership.owner not in (None, Mode.COOPERATIVE)
        state = self._input(stamp)
        output = self.motion.tick(state)
        self._publish_velocity(JointSample(stamp, velocity=output.velocity))
        if output.setpoint is not None:
            self._publish_setpoint(JointSample(stamp, *output.setpoint))
        self._record(state, output)
        self._report(output)

    def _record(self, i: MotionInput, output: MotionOutput) -> None:
        if self._publish_inputs.wanted():
            mode = MODE_CODES[self.motion.ownership.owner]
            stamps = (i.stamp, i.joints_stamp, i.twist_stamp)
            record = MotionRecord(self._tick_count, *stamps, int(i.enabled), mode, int(output.reason), self._version)
            self._publish_inputs(TextSample(record_text(record)))
        self._tick_count += 1

    def _command(self, mode: Mode) -> Callable[[Any], None]:
        topic = f"command/{mode.value}"

        def on_command(sample: Any) -> None:
            now = self._now()
            try:
                self.motion.command(mode, sample, self._input(now), self._living.count(topic, now))
            except Sher3Error as error:
                self._refuse(error, mode.value)
            else:
                if (tell := self._publish_goal.get(mode)) is not None:
                    tell(sample)
                if self._refused is not None and self._refused["command"] == mode.value:
                    self._refused, self._shown = None, ()

        return on_command

    def _no_command(self, mode: Mode) -> Callable[[Sher3Error], None]:
        """Return what refuses a message of a mode that is none: other joint names, another frame."""

        def refuse(error: Sher3Error) -> None:
            details = {"value": error.value, "limit": error.limit, "remedy": error.remedy}
            self._refuse(CommandRejected(mode.value, error.what, **details), mode.value)

        return refuse

    def _on_rcm(self, sample: TextSample) -> None:
        self._change_settings(lambda: apply_rcm_command(self.motion, sample.text, self._joints.position or ()))

    def _on_regime(self, sample: TextSample) -> None:
        """Take a slower regime at once; announce a faster one, since the drives' own limits have to be raised first."""
        busy = self.motion.ownership.owner is not None

        def change() -> None:
            regime = parse_regime(sample.text, self.motion.regime, busy)
            if regime is Regime.FREE and self.motion.regime is not Regime.FREE:
                self._next_regime = self._now() + nanoseconds(self.settings.motion.regime_delay)
            else:
                self._next_regime = None
                self.motion.set_regime(regime)

        self._change_settings(change)

    def _begin_regime(self, stamp: int) -> None:
        """Begin the regime that was announced, unless the robot has come into use meanwhile."""
        if self._next_regime is None or stamp < self._next_regime:
            return
        self._next_regime = None
        busy, name = self.motion.ownership.owner is not None, Regime.FREE.value
        self._change_settings(lambda: self.motion.set_regime(parse_regime(name, self.motion.regime, busy)))

    def _change_settings(self, change: Callable[[], None]) -> None:
        """Carry out a change and publish the settings under a new version, or show why it is refused."""
        try:
            change()
        except Sher3Error as error:
            self._refuse(error, "settings")
            return
        self._version += 1
        self._refused, self._shown = None, ()
        self._report_settings()

    def _refuse(self, error: Sher3Error, command: str) -> None:
        """Show a refusal in the status until such a command is taken; a stream that is refused shows it once."""
        shown = {"command": command, "error": type(error).__name__, "text": str(error)}
        if self._refused is None or self._refused["text"] != shown["text"]:
            self._refused = shown
            self._shown = ()
            self._publish_error(TextSample(str(error)))

    def _singularity(self, reason: Reason) -> dict[str, Any] | None:
        """Return how near the robot is to which singularity when it has stopped at one, else None."""
        q = self._joints.position
        if reason is not Reason.SINGULAR or q is None:
            return None
        return self.motion.velocity_modes.kinematics.singularity_distance(q)._asdict()

    def _tell(self, stamp: int) -> None:
        """Publish the numbers behind the status, and the settings again: nobody else's are in force for longer."""
        self._report_settings()
        motion, q = self.motion, self._joints.position
        modes, speed = motion.velocity_modes, 0.0
        if q is not None and len(q) == len(ACTUATORS):
            speed = float(np.linalg.norm((modes.kinematics.jacobian(q) @ np.array(motion.previous))[:3]))
        values = motion_readings(self._input(stamp), self.settings.motion, speed, modes.cap.linear)
        values.append(("regime", motion.regime.value))
        owner = motion.ownership.owner
        message = "free" if owner is None else owner.value
        self._publish_diagnostics(DiagnosticSample(stamp, "kinematics: inputs", 0, message, tuple(values)))

    def _report_settings(self) -> None:
        centre = self.motion.velocity_modes.centre
        rcm = None if centre is None else centre.tolist()
        regime = self.motion.regime.value
        coming = Regime.FREE.value if self._next_regime is not None else regime
        data = {"version": self._version, "rcm": rcm, "regime": regime, "coming": coming}
        data["settings"] = self.settings.motion.model_dump()
        self._publish_settings(TextSample(json.dumps(data)))

    def _report(self, output: MotionOutput) -> None:
        """Publish the status when it changes. The acceleration limit comes and goes too often to count as a change."""
        reason, limited_by = output.reason, output.limited_by
        owner = self.motion.ownership.owner
        shown = (owner, reason, self.motion.busy, "" if limited_by == "acceleration" else limited_by)
        if shown == self._shown:
            return
        self._shown = shown
        status: dict[str, Any] = {"mode": None if owner is None else owner.value, "since": self.motion.ownership.since}
        status |= {"reason": reason.name, "text": TEXT[reason], "limited_by": shown[3], "is_busy": shown[2]}
        status |= {"rcm_deviation": output.deviation, "singularity": self._singularity(reason)}
        self._publish_status(TextSample(json.dumps({**status, "refused": self._refused})))
