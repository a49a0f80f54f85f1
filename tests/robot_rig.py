"""The stepped robot of the tests, with a scripted surgeon."""

from __future__ import annotations

from sher3_bringup.stepped_robot import SteppedRobot
from sher3_bringup.surgeon.script import Script
from sher3_bringup.surgeon.teleop_node import script_node
from sher3_description import load_robot

ROBOT = load_robot()


class RobotRig(SteppedRobot):
    """Every node of `sher3 up` but the recorder, in one `Graph`."""

    def play(self, script: Script) -> None:
        """Let a scripted surgeon play a script to its end."""
        self.graph.add(script_node, script)
        self.graph.step(round(script.duration * 1e9 / self.graph.clock.period_ns))
