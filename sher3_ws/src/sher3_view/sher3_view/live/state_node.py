"""Publish a running robot the way ROS tools expect it: description, joint states, transforms, legs, typed statuses.

It takes the newest position 50 times a second and wakes nobody. It is no part of the robot: nothing stops when it ends.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from importlib.util import find_spec
from typing import Any

from rcl_interfaces.msg import Log
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.time import Time
from sher3_bags.recording.made import Made
from sher3_bags.recording.robot_frames import PERIOD_NS, SOURCE, RobotFrames
from sher3_bags.recording.typed_status import SOURCES, TypedStatuses
from sher3_common.namespace import in_graph
from sher3_common.samples import TextSample
from sher3_description import Robot
from sher3_runtime.beside import beside
from sher3_runtime.codec.messages import message_class
from sher3_runtime.ports import NODE_OPTIONS, advertise, clock_of, latest, qos_profile

from sher3_view.errors import ViewError
from sher3_view.live.crtk_node import CrtkNode, participant
from sher3_view.live.log_lines import Line, LogLines
from sher3_view.live.parameters_node import ParametersNode
from sher3_view.live.snapshot import Snapshot

LATCHED = DurabilityPolicy.TRANSIENT_LOCAL


class StateNode(Node):
    """Publishes what follows from the newest `measured_js` and the newest statuses, and the log of ROS.

    Attributes:
        left_out: topics whose message type is not installed.
        snapshot: what was heard.
        also: further takers of what is published.
    """

    def __init__(self, robot: Robot, **options: Any) -> None:
        super().__init__("robot_state", **{**NODE_OPTIONS, **options})
        self.left_out: set[str] = set()
        self.snapshot, self.also = Snapshot.empty(), list[Callable[[Made], None]]()
        self._frames, self._typed, self._lines = RobotFrames(robot), TypedStatuses(), LogLines()
        self._newest = {topic: latest(self, topic) for topic in (SOURCE, *SOURCES, "diagnostics")}
        self._heard: dict[str, Any] = {}
        self._by_topic: dict[str, Any] = {}
        self._log = self.create_publisher(Log, "/rosout", QoSProfile(depth=1000, durability=LATCHED))
        for made in self._frames.fixed(clock_of(self).now()):
            self._send(made)

    def listen(self) -> None:
        """Take what has come, and publish nothing."""
        self.snapshot.take(self._newest)

    def step(self) -> None:
        """Publish what follows from the newest position and the newest statuses, where they came."""
        self.listen()
        for topic, sample in self.snapshot.samples.items():
            if self._heard.get(topic) is not sample:
                self._heard[topic] = sample
                self._tell(topic, sample)

    def _tell(self, topic: str, sample: Any) -> None:
        now = clock_of(self).now()
        if topic == SOURCE:
            made = self._frames.state(sample.stamp, sample.position) if sample.position is not None else []
        elif topic == "diagnostics":
            made = []
            self._write(now, self._lines.diagnostic(sample.name, sample.level, sample.message))
        else:
            made = self._typed.follow(topic, sample.text, now)
            self._write(now, self._lines.status(topic, self.snapshot.status(topic)))
        for message in made:
            self._send(message)

    def _write(self, now: int, lines: list[Line]) -> None:
        """Write into the log of ROS, under the name of the node that it is about."""
        for line in lines:
            stamp = Time(nanoseconds=now).to_msg()
            self._log.publish(Log(stamp=stamp, level=line.level, name=line.name, msg=line.text))

    def _send(self, made: Made) -> None:
        for take in self.also:
            take(made)
        if made.topic in self.left_out:
            return
        if made.topic not in self._by_topic:
            if find_spec(made.type.split("/")[0]) is None:
                self.left_out.add(made.topic)
                return
            self._by_topic[made.topic] = self.create_publisher(
                message_class(made.type), in_graph(made.topic), qos_profile(made.qos)
            )
        self._by_topic[made.topic].publish(made.data)


def run(
    robot: Robot, domain: int, seconds: float | None, parameters: bool, crtk: bool, say: Callable[[str], None]
) -> None:
    """Publish the state of the robot of a domain until a signal, or for so many seconds.

    Args:
        robot: the robot.
        domain: of ROS.
        seconds: it lasts; None until a signal.
        parameters: serve the settings as parameters.
        crtk: speak CRTK's types on CRTK's names.
        say: takes a note for the user.

    Raises:
        ViewError: `crtk_msgs` was asked for and is not installed.
    """
    with beside(domain, PERIOD_NS * 1e-9, seconds) as moments:
        node = StateNode(robot)
        served = ParametersNode(node.snapshot, node.listen) if parameters else None
        with _spoken(node, domain) if crtk else nullcontext() as spoken:
            node.step()
            if node.left_out:
                say(f"without {', '.join(sorted(node.left_out))}: `make messages` builds their types")
            for _ in moments:
                node.step()
                for other in (served, spoken):
                    if other is not None:
                        other.step()
        node.destroy_node()


@contextmanager
def _spoken(node: StateNode, domain: int) -> Iterator[CrtkNode]:
    if find_spec("crtk_msgs") is None:
        raise ViewError("crtk_msgs is not installed", remedy="`make messages` builds it, or source a native ROS 2")
    command, context = advertise(node, "command/state_command"), participant(domain)
    try:
        crtk = CrtkNode(lambda text: command(TextSample(text)), context)
        node.also.append(crtk.tell)
        yield crtk
        crtk.destroy_node()
    finally:
        context.try_shutdown()
