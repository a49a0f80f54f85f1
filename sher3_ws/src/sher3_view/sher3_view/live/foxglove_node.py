"""Hears the running robot for Foxglove as the recorder does: it looks 50 times a second and wakes nobody."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.node import Node
from sher3_bags.recording.beside import FOLLOWED, Beside
from sher3_bags.recording.recorder_node import Ears
from sher3_bags.recording.robot_frames import PERIOD_NS
from sher3_description import Robot
from sher3_description.topics import TOPICS
from sher3_runtime.beside import beside
from sher3_runtime.ports import NODE_OPTIONS, clock_of

from sher3_view.live.foxglove_bridge import FoxgloveBridge

LATCHED = "transient_local"


class FoxgloveNode(Node):
    """Hands every sample of the robot to a bridge, and what viewers need beside them: description, frames, statuses."""

    def __init__(self, robot: Robot, bridge: FoxgloveBridge, **options: Any) -> None:
        super().__init__("foxglove", **{**NODE_OPTIONS, **options})
        self._bridge, self._beside = bridge, Beside(robot)
        self._ears = Ears(self, TOPICS, **options)
        now = clock_of(self).now()
        for made in self._beside.fixed(now):
            bridge.send(made.topic, made.type, made.data, now, latched=True)

    def step(self) -> None:
        """Hand over what came since the last call."""
        for arrived, name, data, _ in self._ears.listen():
            topic = TOPICS[name]
            latched = topic.qos.durability == LATCHED
            self._bridge.send(topic.recorded_name, topic.type, data, arrived, latched)
            for made in self._beside.follow(name, data, arrived) if name in FOLLOWED else ():
                self._bridge.send(made.topic, made.type, made.data, arrived, made.qos.durability == LATCHED)
        self._bridge.repeat(clock_of(self).now())


def run(robot: Robot, port: int, domain: int, seconds: float | None, say: Callable[[str], None]) -> None:
    """Serve the robot of a domain on a port of this machine until a signal, or for so many seconds.

    Raises:
        ExtraMissing: foxglove-sdk is not installed.
        ViewError: the port is taken.
    """
    bridge = FoxgloveBridge(port)
    with beside(domain, PERIOD_NS * 1e-9, seconds) as moments:
        try:
            node = FoxgloveNode(robot, bridge)
            say(f"Foxglove: open a connection to {bridge.url}")
            for _ in moments:
                node.step()
            say(f"{sum(bridge.topics.values())} messages of {len(bridge.topics)} topics")
            node.destroy_node()
        finally:
            bridge.close()
