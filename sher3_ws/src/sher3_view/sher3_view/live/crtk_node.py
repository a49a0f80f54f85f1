"""CRTK's own message types on CRTK's own names, for a client that has `crtk_msgs`.

The robot's nodes send and take texts on `operating_state` and `state_command`. A participant of the middleware can have
one type per name, so the types of CRTK have a participant of their own here: a client that knows texts and one that
knows `crtk_msgs` both find what they expect, and neither hears the other.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.node import Node
from sher3_bags.recording.made import Made
from sher3_bags.recording.typed_status import LATCHED, OPERATING_STATE
from sher3_common.namespace import graph_namespace
from sher3_runtime.codec.messages import message_class
from sher3_runtime.ports import NODE_OPTIONS, qos_profile

COMMAND = "crtk_msgs/msg/StringStamped"
QUEUE = 10
"""State commands that may wait; a client sends one and waits for the state."""


class CrtkNode(Node):
    """Sends the operating state as CRTK has it, and hands on the state commands that come.

    Args:
        command: takes the text of a state command.
        context: of a participant in which nobody has these names with another type.

    Raises:
        ModuleNotFoundError: `crtk_msgs` is not installed.
    """

    def __init__(self, command: Callable[[str], None], context: Context, **options: Any) -> None:
        state, asked = message_class(OPERATING_STATE), message_class(COMMAND)
        super().__init__("crtk", context=context, **{**NODE_OPTIONS, **options})
        self._command, self._kind = command, asked
        self._state = self.create_publisher(state, f"{graph_namespace()}/operating_state", qos_profile(LATCHED))
        self._asked = self.create_subscription(asked, f"{graph_namespace()}/state_command", lambda _: None, QUEUE)

    def tell(self, made: Made) -> None:
        """Send a message if it is the operating state."""
        if made.type == OPERATING_STATE:
            self._state.publish(made.data)

    def step(self) -> None:
        """Hand on the commands that have come."""
        for _ in range(QUEUE):
            if (taken := self._asked.handle.take_message(self._kind, False)) is None:
                return
            self._command(taken[0].string)


def participant(domain: int) -> Context:
    """Return a participant of its own in a domain; who asks for it shuts it down."""
    context = Context()
    rclpy.init(context=context, domain_id=domain)
    return context
