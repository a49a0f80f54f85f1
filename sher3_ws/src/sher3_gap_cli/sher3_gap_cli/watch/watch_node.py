"""The node of `sher3 gap watch`: joint states and commands in, DiagnosticArray at 1 Hz out."""

from __future__ import annotations

import struct
import time
from collections.abc import Callable, Sequence
from multiprocessing import get_context
from multiprocessing.pool import AsyncResult
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray
from trajectory_msgs.msg import JointTrajectory

from sher3_gap_cli.watch.judged import STALE, Status, judged, yielding
from sher3_gap_cli.watch.trajectory import Point
from sher3_gap_cli.watch.window import Window

DEPTH = 100
"""Messages that wait at most."""
STAMPED = 12
"""Bytes of a serialised message up to the end of its stamp: four of the encapsulation, eight of the stamp."""
POLLED = 0.02
"""Period with which topics are looked at, s: `DEPTH` messages of 1 kHz last five times as long."""
PUBLISHED = 1.0
"""Period of the diagnostics, s."""
Say = Callable[[Sequence[Status]], None]


class WatchNode(Node):
    """Diagnoses the last seconds of a robot again and again.

    Args:
        model: text of its URDF or MJCF.
        window: of the joints of the model.
        every: seconds from one diagnosis to the next.
        states, command: topics; no command: empty.
        kind: type of the command, `JointState`, `Float64MultiArray` or `JointTrajectory`.
        reliable: whether messages must arrive; sensors' topics are often best effort.
        say: gets what is new.
    """

    def __init__(
        self, model: str, window: Window, every: float, states: str, command: str, kind: str, reliable: bool, say: Say
    ) -> None:
        super().__init__("gap_watch")
        self.model, self.window, self.every, self.say = model, window, every, say
        self.states = states
        self.found: list[Status] = []
        self.pool = get_context("spawn").Pool(1, yielding)
        self.running: AsyncResult[list[Status]] | None = None
        self.last = 0.0
        wanted = ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT
        quality = QoSProfile(depth=DEPTH, reliability=wanted)
        self.heard = [(self._subscription(JointState, states, quality), self._state)]
        if command:
            taken = {
                "JointState": (JointState, self._joint_command),
                "Float64MultiArray": (Float64MultiArray, self._array),
                "JointTrajectory": (JointTrajectory, self._trajectory),
            }[kind]
            self.heard.append((self._subscription(taken[0], command, quality), taken[1]))
        self.publisher = self.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self.published = 0.0

    def _subscription(self, kind: type, topic: str, quality: QoSProfile) -> Any:
        """Subscribe as bytes that `poll` takes: no executor wakes for each of them."""
        return self.create_subscription(kind, topic, lambda _: None, quality, raw=True)

    def poll(self) -> None:
        """Take what has arrived, and publish once a second."""
        for subscription, take in self.heard:
            with subscription.handle:
                while (found := subscription.handle.take_message(subscription.msg_type, True)) is not None:
                    take(found[0], 1e-9 * found[1]["source_timestamp"])
        if time.monotonic() >= self.published + PUBLISHED:
            self.published = time.monotonic()
            self._tick()

    def _state(self, data: bytes, sent: float) -> None:
        """Take joint states; those that the window passes over are not decoded."""
        if self.window.due(stamp_of(data)):
            message = deserialize_message(data, JointState)
            self.window.state(_seconds(message.header.stamp), message.name, message.position, message.effort)

    def _joint_command(self, data: bytes, sent: float) -> None:
        message = deserialize_message(data, JointState)
        self.window.command(_seconds(message.header.stamp), message.name, message.position or message.effort)

    def _array(self, data: bytes, sent: float) -> None:
        """Take an array, which has no stamp of its own, by the time at which it was sent."""
        self.window.command(sent, (), deserialize_message(data, Float64MultiArray).data)

    def _trajectory(self, data: bytes, sent: float) -> None:
        message = deserialize_message(data, JointTrajectory)
        start = _seconds(message.header.stamp) or sent  # no stamp: at once
        points = [
            Point(_seconds(p.time_from_start), p.positions, p.velocities, p.accelerations) for p in message.points
        ]
        self.window.trajectory(start, message.joint_names, points)

    def _tick(self) -> None:
        if self.running is not None and self.running.ready():
            self.found, self.running = self.running.get(), None
            self.say(self.found)
        now = time.monotonic()
        taken = self.window.taken() if self.running is None and now > self.last + self.every else None
        if taken is not None:
            self.running = self.pool.apply_async(judged, (self.model, self.window.joints, tuple(taken)))
            self.last = now
        waits = [Status("gap", STALE, self.window.waits_for(self.states))]
        if not self.last and self.found != waits:
            self.found = waits
            self.say(waits)
        self.publisher.publish(self._message())

    def _message(self) -> Any:
        message = DiagnosticArray()
        message.header.stamp = self.get_clock().now().to_msg()
        message.status = [
            DiagnosticStatus(
                level=bytes([s.level]),
                name=s.name,
                message=s.message,
                hardware_id="gap_watch",
                values=[KeyValue(key=k, value=v) for k, v in s.values.items()],
            )
            for s in self.found
        ]
        return message

    def destroy_node(self) -> None:
        """Leave the graph; a diagnosis that still runs is dropped."""
        self.pool.terminate()
        super().destroy_node()


def stamp_of(data: bytes) -> float:
    """Return the stamp, s, of a serialised message whose first field is a header; 0 where it is too short."""
    if len(data) < STAMPED:
        return 0.0
    seconds, nanoseconds = struct.unpack_from("<iI" if data[1] & 1 else ">iI", data, 4)
    return float(seconds) + 1e-9 * float(nanoseconds)


def _seconds(stamp: Any) -> float:
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


def run(make: Callable[[], WatchNode]) -> None:
    """Run the node until it is interrupted."""
    rclpy.init()
    node = make()
    try:
        while rclpy.ok():
            node.poll()
            time.sleep(POLLED)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
