"""The surgeon at the keyboard as a node: it sends what the keys ask for, and hears what the robot answers."""

from __future__ import annotations

import json
from typing import Any

from sher3_common.samples import TextSample
from sher3_runtime.ports import advertise, clock_of, latest
from sher3_view.live.snapshot import TOPICS, Snapshot
from std_srvs.srv import Trigger

from sher3_bringup.surgeon.keyboard import KEYS, TARE, Asked, Keyboard
from sher3_bringup.surgeon.panel import panel_lines
from sher3_bringup.surgeon.teleop_node import Hands, TeleopNode


class KeyboardNode(TeleopNode):
    """Hand and foot of the keyboard, or of a device beside it, and the robot's answers.

    Attributes:
        snapshot: what was heard of the robot.
        answer: to the last tare.
    """

    def __init__(self, keyboard: Keyboard, hands: Hands | None = None, **options: Any) -> None:
        super().__init__(hands or keyboard.hands, **options)
        self.snapshot, self.answer = Snapshot.empty(), ""
        self._keyboard = keyboard
        self._newest = {topic: latest(self, topic) for topic in TOPICS}
        topics = {asked.topic for asked in KEYS.values()} - {TARE}
        self._publish = {topic: advertise(self, topic) for topic in topics - {"command/state_command"}}
        self._publish["command/state_command"] = self._publish_command
        self._tare = self.create_client(Trigger, TARE)

    def look(self, hand: str, width: int) -> list[str]:
        """Send what was asked for, take what has come, and return the panel."""
        for asked in self._keyboard.asked():
            self._ask(asked)
        self.snapshot.take(self._newest)
        return panel_lines(self.snapshot, hand, self.answer, clock_of(self).now(), width)

    def _ask(self, asked: Asked) -> None:
        if asked.topic != TARE:
            self._publish[asked.topic](TextSample(asked.text))
        elif not self._tare.service_is_ready():
            self.answer = "tare: the cooperative law is not there"
        else:
            self.answer = "tare: asked for"
            self._tare.call_async(Trigger.Request()).add_done_callback(self._tared)

    def _tared(self, future: Any) -> None:
        result = future.result()
        self.answer = f"tare done: {_bias(result.message)}" if result.success else result.message


def _bias(message: str) -> str:
    """Return the bias of a tare in words."""
    try:
        bias = json.loads(message)["bias"]
        return "force {:+.3f} {:+.3f} {:+.3f} N".format(*bias[:3])
    except (ValueError, KeyError, TypeError, IndexError):
        return message
