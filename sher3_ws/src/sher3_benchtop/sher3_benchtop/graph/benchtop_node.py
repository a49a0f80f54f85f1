"""Plays a timeline of the bench-top evaluation into the graph: one command and one load per tick, and watches."""

from __future__ import annotations

from typing import Any

import numpy as np
from rclpy.node import Node
from sher3_common.operating_state import OperatingState, StateCommand
from sher3_common.samples import JointSample, JoySample, PoseSample, TextSample, WrenchSample
from sher3_control.nodes.heard import status_of
from sher3_description import Robot
from sher3_runtime.ports import NODE_OPTIONS, advertise, on_tick, subscribe

from sher3_benchtop.fixture import wrench_at_tip
from sher3_benchtop.protocol.timeline import Timeline

UPRIGHT = (0.0, 0.0, 0.0, 1.0)
SETTLE, START = 100, 150
"""Ticks before the state command, and before the timeline begins."""


class BenchtopNode(Node):
    """The operator of the bench: enables the robot, then sends the timeline.

    Attributes:
        objection: why the robot did not do as commanded, empty while it does.
    """

    def __init__(self, timeline: Timeline, robot: Robot, **options: Any) -> None:
        super().__init__("benchtop", **{**NODE_OPTIONS, **options})
        self.objection = ""
        self._wrenches = [tuple(row) for row in wrench_at_tip(robot, timeline.forces).tolist()]
        self._commands = [tuple(row) for row in np.asarray(timeline.commands).tolist()]
        self._cartesian = timeline.mode == "servo_cp"
        self._tick_count = -1
        self._publish = advertise(self, f"command/{timeline.mode}")
        self._publish_state = advertise(self, "command/state_command")
        self._publish_wrench = advertise(self, "mock/contact_wrench")
        self._publish_pedal = advertise(self, "mock/pedal")
        subscribe(self, "motion/status", self._on_motion)
        subscribe(self, "operating_state", self._on_state)
        # The command is there before the tick it is for is computed: the robot's nodes come later in the tick.
        on_tick(self, self._tick)

    def _tick(self, stamp: int) -> None:
        self._tick_count += 1
        k = self._tick_count - START
        self._publish_pedal(JoySample(stamp, (0.0,), (0,)))
        if self._tick_count == SETTLE:
            self._publish_state(TextSample(StateCommand.ENABLE.value))
        if not 0 <= k < len(self._commands):
            return
        self._publish_wrench(WrenchSample(stamp, self._wrenches[k]))
        if self._cartesian:
            self._publish(PoseSample(stamp, self._commands[k], UPRIGHT))
        else:
            self._publish(JointSample(stamp, self._commands[k]))

    @property
    def running(self) -> bool:
        """Whether the timeline is being sent."""
        return 0 < self._tick_count - START < len(self._commands)

    def _on_motion(self, sample: TextSample) -> None:
        status = status_of(sample.text)
        if status.get("refused"):
            self.objection = self.objection or status["refused"]["text"]
        elif self.running and status.get("reason") != "MOVING":
            self.objection = self.objection or status.get("text", "motion/status is damaged")

    def _on_state(self, sample: TextSample) -> None:
        if self.running and sample.text != OperatingState.ENABLED:
            self.objection = self.objection or f"the operating state became {sample.text}"
