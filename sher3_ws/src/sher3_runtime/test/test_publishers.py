"""A publisher that was killed counts as dead at once; one whose process is unknown lives until its lease ends."""

from __future__ import annotations

import os
import subprocess
import sys
import time

import pytest
import rclpy
from rclpy.context import Context
from rclpy.node import Node
from sher3_description import TOPICS
from sher3_runtime.domains import own_domain
from sher3_runtime.environment import apply, child_environment, graph_environment
from sher3_runtime.ports import NODE_OPTIONS, advertise
from sher3_runtime.publishers import VENDOR, Publishers, processes_of, runs

TOPIC = "command/servo_jp"
PUBLISHES = """
import rclpy, time
from rclpy.node import Node
from sher3_runtime.ports import NODE_OPTIONS, advertise
rclpy.init()
node = Node("user", **NODE_OPTIONS)
publish = advertise(node, "command/servo_jp")
time.sleep(60)
"""


def test_the_process_of_an_identity_is_found_by_the_lower_half_of_its_number():
    low = (os.getpid() & 0xFFFF).to_bytes(2, "little")
    assert os.getpid() in processes_of(VENDOR + b"\0\0" + low + bytes(10))
    assert processes_of(b"\x01\x10\0\0" + low + bytes(10)) == [], "another vendor writes something else there"
    assert processes_of(VENDOR + b"\0\0\0\0" + bytes(10)) == [], "there is no process 0"


def test_a_process_that_has_ended_and_was_not_collected_yet_does_not_run():
    child = subprocess.Popen([sys.executable, "-c", ""])
    os.waitid(os.P_PID, child.pid, os.WEXITED | os.WNOWAIT)
    assert os.path.exists(f"/proc/{child.pid}") and not runs(child.pid)
    child.wait()
    assert not runs(child.pid)


class Told:
    """A node that is told who publishes."""

    def __init__(self):
        self.identities, self.looks = [], 0

    def resolve_topic_name(self, name):
        return name

    def count_publishers(self, name):
        return len(self.identities)

    def get_publishers_info_by_topic(self, name):
        self.looks += 1
        return [type("Info", (), {"endpoint_gid": list(identity)}) for identity in self.identities]


def test_only_a_process_that_was_seen_here_can_be_gone():
    child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
    here = VENDOR + b"\0\0" + (child.pid & 0xFFFF).to_bytes(2, "little") + bytes(10)
    stranger = b"\x01\x10" + bytes(14)
    node = Told()
    publishers = Publishers(node)
    node.identities = [here]
    assert [publishers.count(TOPIC, now) for now in range(5)] == [1] * 5 and node.looks == 1
    node.identities = [here, stranger]
    assert publishers.count(TOPIC, 5) == 2
    child.kill()
    child.wait()
    assert publishers.count(TOPIC, 6) == 1
    assert Publishers(node).count(TOPIC, 7) == 2, "who was never seen alive is left to the lease"


@pytest.mark.flaky(reruns=2)
def test_a_publisher_that_was_killed_is_forgotten_at_once():
    environment = graph_environment(own_domain())
    apply(int(environment["ROS_DOMAIN_ID"]))
    context = Context()
    rclpy.init(context=context)
    node = Node("mode", **{**NODE_OPTIONS, "context": context})
    full, publishers = TOPICS[TOPIC].full_name, Publishers(node)
    mine = advertise(node, TOPIC)
    command = [sys.executable, "-c", PUBLISHES]
    child = subprocess.Popen(command, env=child_environment(**environment))
    try:
        until = time.monotonic() + 30.0
        while publishers.count(TOPIC, time.monotonic_ns()) < 2 and time.monotonic() < until:
            time.sleep(0.01)
        assert publishers.count(TOPIC, time.monotonic_ns()) == 2 and mine is not None
        child.kill()
        killed = time.monotonic()
        while publishers.count(TOPIC, time.monotonic_ns()) > 1 and time.monotonic() < killed + 5.0:
            time.sleep(0.001)
        assert time.monotonic() - killed < 0.1
        assert node.count_publishers(full) == 2, "the middleware still knows both"
    finally:
        child.kill()
        child.wait()
        node.destroy_node()
        context.try_shutdown()
