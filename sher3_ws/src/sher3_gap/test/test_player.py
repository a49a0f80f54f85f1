"""The player: enables, goes to the start, streams every tick once and early."""

from dataclasses import replace

import numpy as np
import pytest
from sher3_gap.excitation import excite
from sher3_gap.excitation.excite_node import trimmed
from sher3_gap.excitation.player import AHEAD, Phase, Player, PlayError
from simulated import ROBOT, runs_of

T = 2_000_000
START = 1_000_000_000_000_000_000


class FakeGraph:
    """Follows the player as supervisor and kinematics node would."""

    def __init__(self, player):
        self.player, self.stamp = player, START
        self.commands, self.points, self.loads, self.moves = [], [], {}, 0

    def step(self):
        command, move, points, load = self.player.tick(self.stamp)
        heard = self.player.heard
        if command:
            self.commands.append(command)
            heard.state, heard.position = "ENABLED", (0.001,) * 5
        if move:
            self.moves += 1
            heard.position = self.player.start
        self.points += [(self.stamp, p) for p in points]
        self.loads[self.stamp] = load
        self.stamp += T

    def run(self, limit=6000):
        for _ in range(limit):
            if self.player.phase is Phase.DONE:
                return
            self.step()


def test_the_player_sends_every_set_point_once_and_early():
    excitation = excite("sweep", ROBOT, posture="p1", duration=2.5)
    graph = FakeGraph(Player(excitation, ROBOT))
    graph.run()
    assert (graph.commands, graph.moves) == (["enable"], 1)
    player = graph.player
    stamps = np.array([p.stamp for _, p in graph.points])
    assert (stamps == player.first + T * np.arange(len(excitation.position))).all()
    assert np.allclose([p.position for _, p in graph.points], excitation.position)
    lead = stamps - np.array([sent for sent, _ in graph.points])
    assert (lead >= 0.9 * AHEAD * 1e9).all() and (lead <= 1.1 * AHEAD * 1e9).all()


def test_loads_are_applied_on_their_plateaus():
    excitation = excite("loads", ROBOT, duration=2.5)
    graph = FakeGraph(Player(excitation, ROBOT))
    graph.run()
    for start, stop, *force in excitation.loads:
        middle = graph.player.first + round((start + stop) / 2e-9 / T) * T
        assert graph.loads[middle][:3] == pytest.approx(force)
    assert graph.loads[START] == (0.0,) * 6


def test_a_robot_that_stops_on_the_way_ends_the_play():
    graph = FakeGraph(Player(excite("sweep", ROBOT, duration=2.5), ROBOT))
    graph.run(900)
    assert graph.player.phase is Phase.PLAY
    graph.player.heard.state = "FAULT"
    with pytest.raises(PlayError, match="stopped while playing"):
        graph.step()


def test_a_robot_in_fault_or_silent_is_not_waited_for_for_ever():
    player = Player(excite("sweep", ROBOT, duration=2.5), ROBOT)
    player.tick(START)
    with pytest.raises(PlayError, match="waiting for the robot to be enabled"):
        player.tick(START + 61_000_000_000)
    player = Player(excite("sweep", ROBOT, duration=2.5), ROBOT)
    player.heard.state = "FAULT"
    with pytest.raises(PlayError, match="FAULT"):
        player.tick(START)


def test_a_recording_is_trimmed_to_the_excitation():
    (run,) = runs_of(["sweep"], repeats=1, duration=2.5)
    first = int(run["measured_js"].stamp[100])
    cut = trimmed(replace(run), first, first + 500 * T)
    assert len(cut["measured_js"]) == 501 and cut.start >= first
    assert len(cut["measured_js"].position) == 501
