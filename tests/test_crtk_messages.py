"""A client with `crtk_msgs`: it drives the robot's states in CRTK's own types, while clients with texts go on."""

from __future__ import annotations

import subprocess
from importlib.util import find_spec

import pytest
from processes import child_environment, sher3_command

pytestmark = [
    pytest.mark.graph,
    pytest.mark.flaky(reruns=2),
    pytest.mark.skipif(find_spec("crtk_msgs") is None, reason="no crtk_msgs: set-up found no C compiler"),
]
CLIENT = """
import sys, time, rclpy
from crtk_msgs.msg import OperatingState, StringStamped
from rclpy.qos import DurabilityPolicy, QoSProfile
from sher3_runtime import environment

environment.apply(int(sys.argv[1]))
rclpy.init()
node, states = rclpy.create_node("client", namespace="/sher3"), []
latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
node.create_subscription(OperatingState, "operating_state", lambda m: states.append((m.state, m.is_homed)), latched)
ask = node.create_publisher(StringStamped, "state_command", 10)

def reach(command, state, patience=40.0):
    end = time.monotonic() + patience
    while not (states and states[-1][0] == state) and time.monotonic() < end:
        ask.publish(StringStamped(string=command))
        until = time.monotonic() + 0.3
        while time.monotonic() < until:
            rclpy.spin_once(node, timeout_sec=0.05)
    print(command, states[-1] if states else None, flush=True)

reach("enable", "ENABLED")
reach("pause", "PAUSED")
reach("disable", "DISABLED")
"""


@pytest.fixture
def running(domain):
    """A robot, and the program that speaks CRTK beside it."""
    processes = []
    up = ["up", "--patient", "--layout", "composed", "--duration", "120"]
    for command in (up, ["state", "--crtk", "--for", "120"]):
        processes.append(subprocess.Popen(sher3_command(*command, "--domain", str(domain)), env=child_environment()))
    try:
        yield domain
    finally:
        for process in reversed(processes):
            process.terminate()
            process.wait(30.0)


def test_the_states_are_driven_and_read_in_crtk_types(running):
    client = [sher3_command()[0], "-c", CLIENT, str(running)]
    result = subprocess.run(client, env=child_environment(), capture_output=True, text=True, timeout=180)
    told = [line.split(" ", 1) for line in result.stdout.splitlines()]
    assert [word for word, _ in told] == ["enable", "pause", "disable"], result.stdout + result.stderr
    assert ["'ENABLED'" in told[0][1], "'PAUSED'" in told[1][1], "'DISABLED'" in told[2][1]] == [True] * 3, told
