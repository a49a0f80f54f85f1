"""Hand and foot of the live page move a mock robot, in stepped time."""

import numpy as np
import pytest
from robot_rig import ROBOT, RobotRig
from sher3_bags.recording.live import recorded
from sher3_runtime import Graph
from sher3_view.live.hand import Hand
from sher3_view.live.view_node import ViewNode

pytestmark = pytest.mark.graph


def test_an_untouched_hand_publishes_nothing_and_a_push_moves_the_tip(bag_folder):
    with Graph(period=ROBOT.control_period, middleware=False) as graph:
        robot = RobotRig(graph, robot=ROBOT)
        with recorded(graph, bag_folder.name, robot=ROBOT):
            view = graph.add(ViewNode)
            graph.step(60)
            view.act(Hand())
            assert view.count_publishers("/sher3/mock/pedal") == 0
            hand = Hand(touched=True, command="enable")
            for _ in range(60):
                view.act(hand)
                graph.step(5)
            assert hand.command == ""
            view.look()
            assert view.snapshot.status("supervisor/status")["state"] == "ENABLED"
            start = robot.plant.plant.true_tip[1].copy()
            hand.pedal, hand.force = True, (1.0, 0.0, 0.0)
            for _ in range(60):
                view.act(hand)
                graph.step(5)
            moved = robot.plant.plant.true_tip[1] - start
    assert moved[0] > 1e-4 and moved[0] > 5 * np.abs(moved[1:]).max()
