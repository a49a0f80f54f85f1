"""The settings in force as parameters of a node beside the robot; `ros2 param` lists, gets and sets them."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from sher3_common.samples import TextSample
from sher3_runtime.ports import NODE_OPTIONS, advertise

from sher3_view.live.parameters import SETTABLE, Command, Value, parameters_of
from sher3_view.live.snapshot import Snapshot

PATIENCE = 1.0
"""Seconds within which a node answers a command: it does so at its next tick."""


class ParametersNode(Node):
    """Mirrors the settings that were heard; a change is a command to the node that owns the setting.

    Args:
        snapshot: what is heard of the robot.
        listen: takes what has come into the snapshot.
    """

    def __init__(self, snapshot: Snapshot, listen: Callable[[], None], **options: Any) -> None:
        stated: dict[str, Any] = {**NODE_OPTIONS, "start_parameter_services": True, **options}
        super().__init__("parameters", **stated)
        self._snapshot, self._listen = snapshot, listen
        self._known: dict[str, Value] = {}
        self._publish = {topic: advertise(self, topic) for topic in {c.topic for c in SETTABLE.values()}}
        self._mirroring = False
        self.add_on_set_parameters_callback(self._asked)
        self._served = SingleThreadedExecutor(context=self.context)
        self._served.add_node(self)

    def step(self) -> None:
        """Mirror what has changed, and serve who asks."""
        self._mirror()
        self._served.spin_once(timeout_sec=0.0)

    def _mirror(self) -> None:
        found = parameters_of(self._snapshot.status("admittance/settings"), self._snapshot.status("motion/settings"))
        if found == self._known:
            return
        self._mirroring = True
        try:
            for name, value in found.items():
                if name not in self._known:
                    self.declare_parameter(name, value)
            self.set_parameters([Parameter(name, value=value) for name, value in found.items()])
        finally:
            self._mirroring = False
        self._known = found

    def _asked(self, parameters: list[Any]) -> SetParametersResult:
        """Answer a wish to change parameters, once the node that owns each has answered."""
        if self._mirroring:
            return SetParametersResult(successful=True)
        for parameter in parameters:
            command = SETTABLE.get(parameter.name)
            if command is None:
                return SetParametersResult(
                    successful=False, reason=f"{parameter.name} is fixed at the start of the robot"
                )
            if reason := self._change(parameter.name, command, parameter.value):
                return SetParametersResult(successful=False, reason=reason)
        return SetParametersResult(successful=True)

    def _change(self, name: str, command: Command, value: Any) -> str:
        """Send a change and wait for the answer; return why it is refused, empty when it is in force."""
        before = self._snapshot.samples.get(command.settings)
        refused = self._snapshot.status(command.status).get("refused")
        self._publish[command.topic](TextSample(command.text.format(value)))
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            self._listen()
            if self._snapshot.samples.get(command.settings) is not before:
                return ""
            now = self._snapshot.status(command.status).get("refused")
            if now and now != refused:
                break
            time.sleep(0.005)
        now = self._snapshot.status(command.status).get("refused")
        return str(now.get("text", now)) if now else f"{name}: no answer; is the robot running?"
