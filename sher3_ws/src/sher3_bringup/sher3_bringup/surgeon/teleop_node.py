"""The surgeon of a mock robot as a node: hand and foot from a script or from the keyboard."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from sher3_common.operating_state import OperatingState, StateCommand
from sher3_common.samples import JoySample, TextSample, WrenchSample
from sher3_common.vectors import Wrench
from sher3_runtime import environment
from sher3_runtime.execution.spinning import spin
from sher3_runtime.ports import NODE_OPTIONS, PERIOD_VARIABLE, advertise, clock_of, on_tick, subscribe
from sher3_runtime.process import stop_on_signals

from sher3_bringup.surgeon.script import Script

Hands = Callable[[float], tuple[float, Wrench]]
"""Pedal travel and wrench on the tip in {b} at a time [s] since the first tick."""

HAND_PERIOD_NS = 4_000_000
"""Period of the surgeon's samples, 4 ms: ten times faster than a hand."""


class TeleopNode(Node):
    """Publishes what the surgeon does, at every tick or every 4 ms, whichever is longer.

    Attributes:
        elapsed: seconds since the first tick.
    """

    def __init__(self, hands: Hands, commands: Callable[[float], str] = lambda _: "", **options: Any) -> None:
        """Take the hands, and the state command to send at a time, empty for none."""
        super().__init__("teleop", **{**NODE_OPTIONS, **options})
        self._hands, self._commands = hands, commands
        self._publish_wrench = advertise(self, "mock/contact_wrench")
        self._publish_pedal = advertise(self, "mock/pedal")
        self._publish_command = advertise(self, "command/state_command")
        self._start = 0
        self.elapsed = 0.0
        on_tick(self, self._tick, every=max(1, HAND_PERIOD_NS // clock_of(self).period_ns))

    def _tick(self, stamp: int) -> None:
        self._start = self._start or stamp
        self.elapsed = (stamp - self._start) * 1e-9
        if command := self._commands(self.elapsed):
            self._publish_command(TextSample(command))
        pedal, wrench = self._hands(self.elapsed)
        self._publish_pedal(JoySample(stamp, (pedal,), (0,)))
        self._publish_wrench(WrenchSample(stamp, wrench))


REPEAT = 0.1
"""Seconds after which an `enable` that the robot has not answered is sent again."""


class ScriptCommands:
    """The state commands of a script, each once when its step begins.

    Only `enable` is repeated while its step lasts, until the robot is ENABLED for the first time: a robot whose streams
    have just come up refuses it. After that, and after a FAULT, nothing is sent that the script does not say.
    """

    def __init__(self, script: Script) -> None:
        self._script = script
        self._step = -1
        self._sent_at = 0.0
        self._answered = False

    def heard(self, state: str) -> None:
        """Take note of an operating state."""
        self._answered = self._answered or state in (OperatingState.ENABLED, OperatingState.FAULT)

    def __call__(self, elapsed: float) -> str:
        """Return the command that is due, empty for none."""
        step, _ = self._script.step_at(elapsed)
        command = self._script.steps[step].command
        again = command == StateCommand.ENABLE and not self._answered and elapsed - self._sent_at >= REPEAT
        if step == self._step and not again:
            return ""
        self._step, self._sent_at = step, elapsed
        return command


class ScriptNode(TeleopNode):
    """A scripted surgeon, which says the name of each step as it begins."""

    def __init__(self, script: Script, commands: ScriptCommands, **options: Any) -> None:
        super().__init__(script.at, commands, **options)
        self._script, self._step = script, -1
        self._publish_step = advertise(self, "mock/step")

    def _tick(self, stamp: int) -> None:
        super()._tick(stamp)
        step, _ = self._script.step_at(self.elapsed)
        if step != self._step:
            self._step = step
            self._publish_step(TextSample(self._script.steps[step].name))


def script_node(script: Script, **options: Any) -> TeleopNode:
    """Return the node of a scripted surgeon."""
    commands = ScriptCommands(script)
    node = ScriptNode(script, commands, **options)
    subscribe(node, "operating_state", lambda sample: commands.heard(sample.text))
    return node


def run_node(make: Callable[[], TeleopNode], stop: Callable[[TeleopNode], bool], rate: float, domain: int) -> None:
    """Run a surgeon in this process beside a running graph until `stop(node)` or a signal."""
    environment.apply(domain)
    os.environ[PERIOD_VARIABLE] = repr(1.0 / rate)
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    try:
        signalled = stop_on_signals()
        node = make()
        spin([node], stop=lambda: signalled() or stop(node), diagnostics=False)
    finally:
        rclpy.try_shutdown()
