"""Messages for Foxglove over a WebSocket, on this machine alone. Nothing that a viewer sends is taken."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from sher3_bags.messages import schema_text

from sher3_view.errors import ExtraMissing, ViewError
from sher3_view.live import LOOPBACK

REPEAT_NS = 1_000_000_000
"""Time [ns] after which latched messages are sent again: a viewer may come at any time, and the server keeps none."""


class FoxgloveBridge:
    """A server with a channel for each topic, made when its first message comes.

    Args:
        port: it listens on.

    Attributes:
        url: a viewer connects to.
        topics: topic -> number of its messages that were handed to the server.

    Raises:
        ExtraMissing: the library is not installed.
        ViewError: the port is taken.
    """

    def __init__(self, port: int) -> None:
        self.url = f"ws://{LOOPBACK}:{port}"
        self.topics: dict[str, int] = {}
        self._api = _foxglove()
        self._context = self._api.Context()
        try:
            self._server = self._api.start_server(
                name="SHER 3.0", host=LOOPBACK, port=port, capabilities=[], context=self._context
            )
        except RuntimeError as error:
            raise ViewError(f"no server on port {port} ({error})", value=port, remedy="name another --port") from error
        self._channels: dict[str, Any] = {}
        self._latched: dict[str, bytes] = {}
        self._again = 0

    def send(self, topic: str, type_name: str, data: bytes, stamp: int, latched: bool = False) -> None:
        """Hand a message over: absolute topic, type as package/msg/Type, CDR bytes, time of arrival [ns]."""
        if topic not in self._channels:
            schema = self._api.Schema(name=type_name, encoding="ros2msg", data=schema_text(type_name).encode())
            self._channels[topic] = self._api.Channel(
                topic, schema=schema, message_encoding="cdr", context=self._context
            )
        if latched:
            self._latched[topic] = data
        self.topics[topic] = self.topics.get(topic, 0) + 1
        self._channels[topic].log(data, log_time=stamp)

    def repeat(self, stamp: int) -> None:
        """Send latched messages again where it is time; stamp in ns."""
        if stamp >= self._again:
            self._again = stamp + REPEAT_NS
            for topic, data in self._latched.items():
                self._channels[topic].log(data, log_time=stamp)

    def close(self) -> None:
        """Stop the server."""
        self._server.stop()


def _foxglove() -> Any:
    try:
        return import_module("foxglove")
    except ImportError as error:
        raise ExtraMissing("foxglove-sdk", "foxglove") from error
