"""The three control nodes with an ideal robot, force sensor and pedal around them, in stepped time."""

from __future__ import annotations

import json
from contextlib import contextmanager

from law_bench import ROBOT
from rclpy.node import Node
from sher3_common.samples import JointSample, JoySample, TextSample, WrenchSample
from sher3_control.nodes.admittance_node import AdmittanceNode
from sher3_control.nodes.kinematics_node import KinematicsNode
from sher3_control.nodes.supervisor_node import SupervisorNode
from sher3_control.settings import ControlSettings
from sher3_runtime import Graph
from sher3_runtime.ports import NODE_OPTIONS, advertise, on_tick, subscribe

STREAMS = ["setpoint_js", "servo_cv", "servo_jv", "measured_js", "measured_cp", "force/measured_cf", "pedal/measured"]
RECORDS = [f"{node}/{kind}" for node in ("admittance", "motion") for kind in ("inputs", "settings", "status")]
RECORDED = [*STREAMS, *RECORDS, "operating_state", "supervisor/status"]
TEXTS = ["state_command", "admittance", "rcm", "regime"]
COMMANDS = ["servo_cv", "servo_jv", "servo_jp", "servo_cp", "move_jp", "move_cp", *TEXTS]


class IdealRobot(Node):
    """Integrates `servo_jv` exactly; `force` acts on the tip in {t}, `travel` is the pedal. None silences a stream.

    `button` is its emergency stop, or all of its buttons.
    """

    def __init__(self, **options):
        super().__init__("ideal_robot", **{**NODE_OPTIONS, **options})
        self.q, self.velocity = [0.0] * 5, (0.0,) * 5
        self.force, self.travel, self.button = (0.0, 0.0, 0.0), 0.0, 0
        self.joints_alive = True
        self.count = 0
        self._joints, self._wrench = advertise(self, "measured_js"), advertise(self, "force/measured_cf")
        self._pedal = advertise(self, "pedal/measured")
        subscribe(self, "servo_jv", self._on_velocity)
        on_tick(self, self._tick)

    def _on_velocity(self, sample):
        self.velocity = sample.velocity

    def _tick(self, stamp):
        self.q = [q + 0.002 * v for q, v in zip(self.q, self.velocity, strict=True)]
        self.count += 1
        if self.joints_alive:
            self._joints(JointSample(stamp, tuple(self.q)))
        if self.travel is not None:
            buttons = self.button if isinstance(self.button, tuple) else (self.button,)
            self._pedal(JoySample(stamp, (self.travel,), buttons))
        if self.force is not None:
            x, y, z = self.force
            wiggle = 1e-6 * (self.count % 7)
            weight = -ROBOT.force_sensor.tool_mass * 9.81
            self._wrench(WrenchSample(stamp, (x + wiggle, y, z + weight, 0.03 * y, -0.03 * x, 0.0)))


class ControlGraph:
    """The graph, its robot, a probe on everything, and a hand on every command."""

    def __init__(self, graph):
        self.graph = graph
        self.robot = graph.add(IdealRobot)
        no_drives = ControlSettings.from_robot(ROBOT, {"supervisor": {"hand_apart": 10.0}})  # to say what they hold
        self.supervisor = graph.add(SupervisorNode, ROBOT, no_drives)
        bench = ControlSettings.from_robot(ROBOT, {"motion": {"regime": "bench"}})
        self.kinematics = graph.add(KinematicsNode, ROBOT, bench)
        self.admittance = graph.add(AdmittanceNode, ROBOT)
        self.probe = graph.probe(*RECORDED, sends=("diagnostics", *(f"command/{name}" for name in COMMANDS)))
        self.step = graph.step

    @property
    def now(self):
        return self.graph.clock.time_ns

    def text(self, name, text):
        self.probe.send(f"command/{name}", TextSample(text))
        self.graph.settle()

    def enable(self):
        """Let go of the tool, enable, and take hold of it as before."""
        held, self.robot.force = self.robot.force, (0.0, 0.0, 0.0)
        self.step(60 if any(held) else 5)
        # Latched with a depth of one: the next version would take the place of one that is still on its way.
        for topic in ("admittance/settings", "motion/settings"):
            self.graph.until(lambda topic=topic: self.probe.samples[topic], topic)
        self.text("state_command", "enable")
        self.until_state("ENABLED")
        self.until_mode(None)
        self.robot.force = held
        self.step(2)

    def until_state(self, state):
        """Wait until every node has heard of the operating state: latched samples take their own time."""
        nodes = (self.admittance, self.kinematics)
        enabled = state == "ENABLED"
        heard = lambda: all(node.heard.enabled(self.now) == enabled for node in nodes)  # noqa: E731
        self.graph.until(lambda: heard() and self.status("supervisor/status")["state"] == state, state)

    def until_mode(self, mode):
        """Wait until the owner is `mode` and the admittance node has heard of it."""
        free = mode in (None, "cooperative")
        self.graph.until(
            lambda: self.status("motion/status")["mode"] == mode and self.admittance.owns == free, f"mode {mode}"
        )

    def until_reason(self, topic, reason):
        """Wait until a status topic shows a reason."""
        self.graph.until(lambda: self.status(topic)["reason"] == reason, reason)

    def press(self, force=(0.0, 0.0, 0.0)):
        self.robot.travel = 0.0
        self.step(2)
        self.robot.travel, self.robot.force = 1.0, force

    def last(self, topic):
        return self.probe.samples[topic][-1]

    def status(self, topic):
        self.graph.until(lambda: self.probe.samples[topic], topic)
        return json.loads(self.last(topic).text)


@contextmanager
def control_graph():
    with Graph(middleware=False) as graph:
        yield ControlGraph(graph)
