"""A recording played onto a running robot by a foreign player, as `ros2 bag play` does: it moves nothing.

Its messages go by the graph's post, byte by byte as they were recorded. Two names are commands of the user in the graph
and the robot's own output in recordings (`servo_cv`, `servo_jv`), and all others are streams of the robot itself.
"""

from __future__ import annotations

from collections import defaultdict
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from rclpy.node import Node
from robot_rig import ROBOT, RobotRig
from sher3_bags.recording.live import recorded
from sher3_bringup.surgeon.script import Script
from sher3_description import TOPICS
from sher3_runtime import NODE_OPTIONS, Graph
from sher3_runtime.ports import advertise_raw
from sher3_safety.runs.operator_node import OperatorNode

pytestmark = pytest.mark.graph

SURGEON = {
    "schema": "sher3.teleop/1",
    "steps": [
        {"name": "enable", "duration": 0.5, "command": "enable"},
        {"name": "push", "duration": 0.5, "pedal": 1.0, "wrench": [1.0, 0, 0, 0, 0, 0], "ramp": 0.2},
        {"name": "leave", "duration": 0.1},
    ],
}
REST = 25e-6
"""How far a tip may go [m] that nobody moves: what a watch near tissue allows."""


class Player(Node):
    """Sends the messages of a recording at the ticks they were recorded at, under their recorded names."""

    def __init__(self, messages: dict[int, list[tuple[str, bytes]]], **options: Any) -> None:
        super().__init__("rosbag2_player", **{**NODE_OPTIONS, **options})
        self._messages, self._tick = messages, 0
        played = {name for tick in messages.values() for name, _ in tick}
        heard = {topic.full_name: name for name, topic in TOPICS.items()}
        self._send = {name: advertise_raw(self, heard[name]) for name in sorted(played & heard.keys())}

    def play(self) -> None:
        """Send what is due in the next tick and what somebody may hear."""
        for name, data in self._messages.get(self._tick, ()):
            if name in self._send:
                self._send[name](data)
        self._tick += 1


@pytest.fixture(scope="module")
def recording() -> dict[int, list[tuple[str, bytes]]]:
    """Return the messages of a session in which a hand moved the robot, by tick."""
    with Graph(period=ROBOT.control_period, middleware=False) as graph:
        rig = RobotRig(graph)
        with recorded(graph, "bag_play_source", robot=ROBOT) as recorder:
            rig.play(Script.model_validate(SURGEON))
    found = defaultdict(list)
    with next(recorder.recorder.folder.glob("*.mcap")).open("rb") as file:
        messages = [(channel.topic, message) for _, channel, message in make_reader(file).iter_messages()]
    begin = min(message.log_time for _, message in messages)
    for topic, message in messages:
        found[int((message.log_time - begin) * 1e-9 / ROBOT.control_period)].append((topic, message.data))
    return found


@pytest.mark.parametrize("only", ["", "servo_jv", "servo_cv", "force/measured_cf", "supervisor/heartbeat"])
def test_a_recording_that_is_played_onto_a_robot_at_rest_moves_nothing(recording, only, bag_folder):
    messages = {tick: [m for m in sent if not only or m[0] == f"/sher3/{only}"] for tick, sent in recording.items()}
    with Graph(period=ROBOT.control_period, middleware=False) as graph:
        operator, rig = graph.add(OperatorNode), RobotRig(graph)
        with recorded(graph, bag_folder.name, robot=ROBOT):
            graph.step(60)
            operator.command("enable")
            graph.step(100)
            player, tips = graph.add(Player, messages), []
            for _ in range(max(recording) + 50):
                player.play()
                graph.step()
                tips.append(rig.plant.plant.true_tip[1])
    way = np.linalg.norm(np.array(tips) - tips[0], axis=1).max()
    assert sum(map(len, messages.values())) > 50
    assert way < REST, f"{way * 1e6:.1f} um"
