"""The node that listens for the terminal: it takes statuses, and hands on what is new in them.

It is no part of the robot, which goes on without it. It hears no stream of the control loop.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from rclpy.node import Node
from sher3_common import Sher3Error, parse_json
from sher3_common.samples import DiagnosticSample, TextSample
from sher3_runtime.ports import NODE_OPTIONS, subscribe

from sher3_bringup.terminal.status_news import DIAGNOSTICS, SOURCES

Hear = Callable[[str, dict[str, Any]], object]
"""Takes the name of a topic, and its content as plain data."""


def listen(node: Node, hear: Hear) -> None:
    """Let a node hear what the terminal tells."""
    for topic in SOURCES:
        subscribe(node, topic, partial(_diagnostic if topic == DIAGNOSTICS else _status, hear, topic))


class ListenerNode(Node):
    """A node that does nothing but listen."""

    def __init__(self, hear: Hear, **options: Any) -> None:
        super().__init__("terminal", **{**NODE_OPTIONS, **options})
        listen(self, hear)


def _status(hear: Hear, topic: str, sample: TextSample) -> None:
    try:
        data = parse_json(sample.text)
    except Sher3Error:
        return
    if isinstance(data, dict):
        hear(topic, data)


def _diagnostic(hear: Hear, topic: str, sample: DiagnosticSample) -> None:
    hear(topic, {"name": sample.name, "values": sample.values})
