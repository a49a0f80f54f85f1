"""Streams excitations to a running robot, in place of a user."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from rclpy.node import Node
from sher3_common.operating_state import OperatingState, StateCommand
from sher3_common.samples import JointSample, JoySample, TextSample, WrenchSample
from sher3_common.vectors import ZERO_WRENCH, Wrench
from sher3_runtime.ports import NODE_OPTIONS, advertise, on_tick, subscribe

Array = NDArray[np.float64]


class ExcitationNode(Node):
    """Enables the robot and streams set-points and wrenches to it, one of each a tick."""

    def __init__(self, goals: Array, wrenches: Array, **options: Any) -> None:
        super().__init__("excitations", **{**NODE_OPTIONS, **options})
        self._goals, self._wrenches = goals, wrenches
        self._ticks, self._next, self._state = 0, 0, ""
        self._publish_goal = advertise(self, "command/servo_jp")
        self._publish_wrench = advertise(self, "mock/contact_wrench")
        self._publish_pedal = advertise(self, "mock/pedal")
        self._publish_command = advertise(self, "command/state_command")
        subscribe(self, "operating_state", self._on_state)
        on_tick(self, self._tick)

    def _on_state(self, sample: TextSample) -> None:
        self._state = sample.text

    def _tick(self, stamp: int) -> None:
        self._ticks += 1
        self._publish_pedal(JoySample(stamp, (0.0,), (0,)))
        wrench: Wrench = ZERO_WRENCH
        if self._state == OperatingState.ENABLED:
            row = min(self._next, len(self._goals) - 1)
            self._publish_goal(JointSample(stamp, tuple(self._goals[row].tolist())))
            wrench, self._next = tuple(self._wrenches[row].tolist()), self._next + 1
        elif not self._next and self._ticks % 100 == 0:
            self._publish_command(TextSample(StateCommand.ENABLE.value))
        self._publish_wrench(WrenchSample(stamp, wrench))
