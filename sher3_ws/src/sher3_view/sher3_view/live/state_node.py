"""Publish a running robot the way ROS tools expect it: description, joint states, transforms, legs, typed statuses.

It takes the newest position 50 times a second and wakes nobody. It is no part of the robot: nothing stops when it ends.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from importlib.util import find_spec
from typing import Any

import rclpy
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from sher3_bags.recording.made import Made
from sher3_bags.recording.robot_frames import PERIOD_NS, SOURCE, RobotFrames
from sher3_bags.recording.typed_status import SOURCES, TypedStatuses
from sher3_description import Robot
from sher3_runtime import environment
from sher3_runtime.codec.messages import message_class
from sher3_runtime.ports import NODE_OPTIONS, clock_of, latest, qos_profile
from sher3_runtime.process import stop_on_signals


class StateNode(Node):
    """Publishes what follows from the newest `measured_js` and the newest statuses.

    Attributes:
        left_out: topics whose message type is not installed.
    """

    def __init__(self, robot: Robot, **options: Any) -> None:
        super().__init__("robot_state", **{**NODE_OPTIONS, **options})
        self.left_out: set[str] = set()
        self._frames = RobotFrames(robot)
        self._newest = latest(self, SOURCE)
        self._typed = TypedStatuses()
        self._statuses = {topic: latest(self, topic) for topic in SOURCES}
        self._by_topic: dict[str, Any] = {}
        for made in self._frames.fixed(clock_of(self).now()):
            self._send(made)

    def step(self) -> None:
        """Publish what follows from the newest position and the newest statuses, where they came."""
        for topic, take in self._statuses.items():
            if (status := take()) is not None:
                for made in self._typed.follow(topic, status.text, clock_of(self).now()):
                    self._send(made)
        sample = self._newest()
        if sample is not None and sample.position is not None:
            for made in self._frames.state(sample.stamp, sample.position):
                self._send(made)

    def _send(self, made: Made) -> None:
        if made.topic in self.left_out:
            return
        if made.topic not in self._by_topic:
            if find_spec(made.type.split("/")[0]) is None:
                self.left_out.add(made.topic)
                return
            self._by_topic[made.topic] = self.create_publisher(
                message_class(made.type), made.topic, qos_profile(made.qos)
            )
        self._by_topic[made.topic].publish(made.data)


def run(robot: Robot, domain: int, seconds: float | None, say: Callable[[str], None]) -> None:
    """Publish the state of the robot of a domain until a signal, or for so many seconds."""
    environment.apply(domain)
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    try:
        signalled = stop_on_signals()
        node = StateNode(robot)
        node.step()
        if node.left_out:
            say(f"without {', '.join(sorted(node.left_out))}: `make messages` builds their types")
        begin = time.monotonic()
        while not signalled() and (seconds is None or time.monotonic() - begin < seconds):
            now = time.monotonic()
            node.step()
            time.sleep(max(0.0, PERIOD_NS * 1e-9 - (time.monotonic() - now)))
        node.destroy_node()
    finally:
        rclpy.try_shutdown()
