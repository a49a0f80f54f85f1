"""The topic table: names, types, frames and quality of service, in one place and without ROS."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

from sher3_common.namespace import NAMESPACE as NAMESPACE
from sher3_common.namespace import in_graph, prefix


@dataclass(frozen=True)
class Qos:
    """Quality of service as plain data; history is always keep-last.

    Attributes:
        reliability: `reliable` or `best_effort`.
        durability: `volatile`, or `transient_local` for latched topics.
        depth: queue length in messages.
    """

    reliability: Literal["reliable", "best_effort"] = "reliable"
    durability: Literal["volatile", "transient_local"] = "volatile"
    depth: int = 10


@dataclass(frozen=True)
class Topic:
    """One topic.

    Attributes:
        name: Name in recordings relative to `NAMESPACE`, as in `measured_js`; the key of `TOPICS`. It is that of the
            recorded-run contract, section 4.
        type: ROS interface, as in `sensor_msgs/msg/JointState`.
        frame_id: `header.frame_id` of every message, without the robot's prefix; empty where the message belongs to no
            frame.
        qos: Quality of service of publishers and subscribers alike.
        content: What the topic carries, for `--help` and the docs.
        graph: Name in the graph relative to `NAMESPACE`, where it is not `name`. There CRTK's rules hold: commands of
            the user are at the root, and no stream of the robot's own bears the name of a command.
    """

    name: str
    type: str
    frame_id: str
    qos: Qos
    content: str
    graph: str = ""

    @property
    def full_name(self) -> str:
        """The absolute name in the graph, in the namespace of this process's robot.

        `/diagnostics` is outside `/sher3` (ROS convention), but within any other namespace: robots of one domain must
        not take each other's for their own.
        """
        return in_graph(self._absolute(self.graph or self.name))

    @property
    def frame(self) -> str:
        """`header.frame_id` in the graph: with the prefix of this process's robot."""
        return prefix() + self.frame_id if self.frame_id else ""

    @property
    def recorded_name(self) -> str:
        """The absolute name in recordings."""
        return self._absolute(self.name)

    @staticmethod
    def _absolute(name: str) -> str:
        return f"/{name}" if name == "diagnostics" else f"{NAMESPACE}/{name}"

    @property
    def subscriber_qos(self) -> Qos:
        """Quality of service that the control loop's own subscribers ask for.

        Publishers offer `qos`, and a recorder asks for that. The loop does not ask for a lost sample again: the next
        one comes sooner, and acknowledging each would cost the loop time.
        """
        stream = self.qos.durability == "volatile" and not self.name.startswith("command/")
        return replace(self.qos, reliability="best_effort") if stream else self.qos


STREAM = Qos()
AHEAD = Qos(depth=500)
LATCHED = Qos(durability="transient_local", depth=1)

_JOINT = "sensor_msgs/msg/JointState"
_TWIST = "geometry_msgs/msg/TwistStamped"
_POSE = "geometry_msgs/msg/PoseStamped"
_WRENCH = "geometry_msgs/msg/WrenchStamped"
_JOY = "sensor_msgs/msg/Joy"
_TEXT = "std_msgs/msg/String"

_TABLE = (
    # The robot's streams, recorded-run contract version 1, section 4.
    Topic("setpoint_js", _JOINT, "", STREAM, "reference position and velocity, position modes only"),
    Topic("servo_cv", _TWIST, "b", STREAM, "commanded tip twist in {b}, cooperative mode only", graph="setpoint_cv"),
    Topic("servo_jv", _JOINT, "", STREAM, "commanded actuator velocity", graph="drives/command_jv"),
    Topic("drives/setpoint_jv", _JOINT, "", STREAM, "velocity demand executed in the interval that ends at the stamp"),
    Topic("drives/measured_js", _JOINT, "", STREAM, "motor encoder position, motor velocity, effort"),
    Topic("measured_js", _JOINT, "", STREAM, "load encoder position, and its difference to the one before as velocity"),
    Topic("measured_cp", _POSE, "b", STREAM, "tip pose from measured_js"),
    Topic("measured_cv", _TWIST, "b", STREAM, "tip twist from measured_js: its velocity through the Jacobian"),
    Topic("goal_js", _JOINT, "", LATCHED, "goal of the newest move_jp that was taken"),
    Topic("goal_cp", _POSE, "b", LATCHED, "goal of the newest move_cp that was taken"),
    Topic("force/measured_cf", _WRENCH, "f", STREAM, "raw wrench in {f}"),
    Topic("pedal/measured", _JOY, "", STREAM, "one axis, travel 0 to 1, and one button, the emergency stop"),
    Topic("tracker/measured_cp", _POSE, "b", STREAM, "external tip pose in {b}"),
    Topic("temperature", "sensor_msgs/msg/Temperature", "", STREAM, "structure temperature [deg C]"),
    Topic("operating_state", _TEXT, "", LATCHED, "CRTK operating state; why and since when is in supervisor/status"),
    Topic("error", _TEXT, "", STREAM, "CRTK error: a command that was refused, and why; it stays in the status topics"),
    # CRTK commands of the user.
    Topic("command/servo_cv", _TWIST, "b", STREAM, "tip twist in {b}", graph="servo_cv"),
    Topic("command/servo_jv", _JOINT, "", STREAM, "actuator velocity", graph="servo_jv"),
    Topic(
        "command/servo_jp",
        _JOINT,
        "",
        AHEAD,
        "actuator position for the tick of its stamp; may be early",
        graph="servo_jp",
    ),
    Topic("command/move_jp", _JOINT, "", STREAM, "actuator position to go to and stop at", graph="move_jp"),
    Topic("command/servo_cp", _POSE, "b", STREAM, "tip pose in {b} for now", graph="servo_cp"),
    Topic("command/move_cp", _POSE, "b", STREAM, "tip pose in {b} to go to and stop at", graph="move_cp"),
    Topic(
        "command/state_command",
        _TEXT,
        "",
        STREAM,
        "CRTK state command: enable, disable, pause, resume, home, unhome",
        graph="state_command",
    ),
    Topic("command/admittance", _TEXT, "", STREAM, "live parameter of the cooperative mode: `name value`"),
    Topic("command/rcm", _TEXT, "", STREAM, "remote centre: `here DEPTH` or `X Y Z` [m] in {b}, or `off`"),
    Topic("command/regime", _TEXT, "", STREAM, "speed regime: `near_tissue` or `free`"),
    # What the control nodes decided and from what, so that a recording can be computed again bit for bit.
    Topic("admittance/inputs", _TEXT, "", STREAM, "stamps and flags that a tick of the admittance law used"),
    Topic("admittance/settings", _TEXT, "", LATCHED, "settings and live parameters of the admittance law, by version"),
    Topic("admittance/status", _TEXT, "", LATCHED, "why the cooperative mode does not move"),
    Topic("motion/inputs", _TEXT, "", STREAM, "stamps and mode that a tick of the kinematics node used"),
    Topic("motion/settings", _TEXT, "", LATCHED, "settings and remote centre of the kinematics node, by version"),
    Topic("motion/status", _TEXT, "", LATCHED, "owner, reason, is_busy and the last refused command"),
    Topic("supervisor/status", _TEXT, "", LATCHED, "operating state with reason, since when, first and later faults"),
    Topic(
        "supervisor/heartbeat",
        _TEXT,
        "",
        STREAM,
        "`STATE ACTION` at 100 Hz: how hard to stop, and that somebody is there",
    ),
    Topic("diagnostics", "diagnostic_msgs/msg/DiagnosticArray", "", STREAM, "health of every node, with numbers"),
    Topic("gap/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", "", AHEAD, "gap over floor per stage and actuator"),
    # Between a scripted surgeon, the plant process and the device ends of sensor and pedal; mocks only.
    Topic("mock/contact_wrench", _WRENCH, "b", STREAM, "wrench on the tip in {b}, into the plant"),
    Topic(
        "mock/pedal", _JOY, "", STREAM, "one axis, the pedal as the foot presses it, and at most one button, the stop"
    ),
    Topic("mock/step", _TEXT, "", STREAM, "step of the surgeon's script that begins"),
    Topic("mock/force_device", _WRENCH, "f", STREAM, "what the mock force sensor puts on its wire"),
    Topic("mock/pedal_device", _JOY, "", STREAM, "what the mock pedal puts on its wire"),
    Topic("mock/fault", _TEXT, "", STREAM, "fault to inject or to clear, as JSON"),
    Topic("mock/effects", _TEXT, "", STREAM, "effects that the plant has from now on, as a JSON list"),
    Topic("mock/true_js", _JOINT, "", STREAM, "true load position and executed demand, from the first fault on"),
)

AT_ONCE = {"pedal/measured": "buttons"}
"""Field of a stream whose change is heard at once by those, too, that look at the stream at their own pace."""
MANY_SENDERS = frozenset({"diagnostics", "error"})
"""Topics on which several nodes publish; all others have one sender."""

TOPICS: dict[str, Topic] = {topic.name: topic for topic in _TABLE}
"""Every topic by its name relative to `NAMESPACE`."""
