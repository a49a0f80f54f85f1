"""The operator and the surgeon of the matrix: hand, foot, state commands and faults."""

from __future__ import annotations

from operator import add
from typing import Any

from rclpy.node import Node
from sher3_common.operating_state import OperatingState, StateCommand
from sher3_common.samples import JointSample, JoySample, PoseSample, TextSample, WrenchSample
from sher3_common.vectors import Vector
from sher3_faults.kinds import OK
from sher3_faults.requests import make_request
from sher3_runtime import Graph
from sher3_runtime.ports import NODE_OPTIONS, advertise, latest, on_tick, subscribe
from std_srvs.srv import Trigger


class OperatorNode(Node):
    """Publishes hand and foot at every tick.

    Attributes:
        pedal: travel.
        force: of the hand along z of {b} [N].
        across: along x [N].
        state: newest operating state heard.
        height: newest z of the tip heard [m].
        aim: how far from where the axes are the position commands ask them to be (5,) [m, rad]; None: no such command.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__("operator", **{**NODE_OPTIONS, **options})
        self.pedal, self.force, self.state, self.height = 0.0, 0.0, "", 0.0
        self.across = 0.0
        self.aim: Vector | None = None
        self._goal: Vector | None = None
        self._take_joints = latest(self, "measured_js")
        self._publish_goal = advertise(self, "command/servo_jp")
        self._publish_wrench = advertise(self, "mock/contact_wrench")
        self._publish_pedal = advertise(self, "mock/pedal")
        self._publish_command = advertise(self, "command/state_command")
        self._publish_fault = advertise(self, "mock/fault")
        subscribe(self, "operating_state", self._on_state)
        subscribe(self, "measured_cp", self._on_tip)
        on_tick(self, self._tick)

    def command(self, text: str) -> None:
        """Send a state command."""
        self._publish_command(TextSample(text))

    def inject(self, request: str) -> None:
        """Send a request for a fault."""
        self._publish_fault(TextSample(request))

    def _on_state(self, sample: TextSample) -> None:
        self.state = sample.text

    def _on_tip(self, sample: PoseSample) -> None:
        self.height = sample.position[2]

    def _follow_aim(self, stamp: int) -> None:
        """Ask for the place that the aim means at its first tick, and for the same one from then on."""
        joints = self._take_joints()
        if self.aim is None:
            self._goal = None
        elif self._goal is None and joints is not None:
            self._goal = tuple(map(add, joints.position, self.aim))
        if self._goal is not None:
            self._publish_goal(JointSample(stamp, self._goal))

    def _tick(self, stamp: int) -> None:
        self._follow_aim(stamp)
        self._publish_pedal(JoySample(stamp, (self.pedal,), (0,)))
        self._publish_wrench(WrenchSample(stamp, (self.across, 0.0, self.force, 0.0, 0.0, 0.0)))


def tare(graph: Graph) -> Any:
    """Ask for a tare, as a person does before anybody touches the tool; return the answer of the service."""
    client = graph.probe().create_client(Trigger, "admittance/tare")
    graph.until(client.service_is_ready, "tare")
    asked = client.call_async(Trigger.Request())
    graph.until(asked.done, "answer of the tare")
    return asked.result()


FIRST, PRESS = 100, 1000
"""Ticks of the first `enable` and of the press. By then the eight processes run evenly, and the supervisor has heard of
the cycles that were lost at their start."""
RECOVERY: dict[str, str] = {
    OperatingState.FAULT: StateCommand.DISABLE.value,
    OperatingState.PAUSED: StateCommand.RESUME.value,
}


class SurgeonNode(OperatorNode):
    """Asks for `enable` until the robot is enabled, then presses the pedal and pushes, in wall time.

    Args:
        force: of the hand along z of {b} [N].
        pedal: travel.
    """

    def __init__(self, force: float, pedal: float, **options: Any) -> None:
        super().__init__(**options)
        self._aims, self._ticks = (force, pedal), 0

    def _tick(self, stamp: int) -> None:
        self._ticks += 1
        if self._ticks == 1:
            # The plant tells the truth from the first request on.
            self.inject(make_request(component="all", fault=OK).to_json())
        if FIRST <= self._ticks < PRESS and self.state != OperatingState.ENABLED and self._ticks % 20 == 0:
            self.command(RECOVERY.get(self.state, StateCommand.ENABLE.value))
        if self._ticks == PRESS:
            self.force, self.pedal = self._aims
        super()._tick(stamp)
