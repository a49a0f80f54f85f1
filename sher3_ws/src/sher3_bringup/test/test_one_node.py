"""A node as a program of its own: its command line, its package, and a robot of them in another namespace."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from sher3_bringup.processes.one_node import split
from sher3_bringup.settings.run_settings import NODES
from sher3_runtime.domains import PROCESSES, claim_domain, release_domain
from sher3_runtime.environment import child_environment

PACKAGE = Path(__file__).parents[1]
HEAR = """
import sys, time, rclpy
from std_msgs.msg import String
from sher3_runtime import environment
environment.apply(int(sys.argv[1]))
rclpy.init()
node, heard = rclpy.create_node("tool", namespace="/left"), []
from rclpy.qos import QoSProfile, DurabilityPolicy
latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
node.create_subscription(String, "operating_state", lambda m: heard.append(m.data), latched)
node.create_subscription(String, "supervisor/status", lambda m: print(m.data, file=sys.stderr), latched)
ask = node.create_publisher(String, "state_command", 10)
end = time.monotonic() + 60.0
while "ENABLED" not in heard and time.monotonic() < end:
    ask.publish(String(data="disable" if heard[-1:] == ["FAULT"] else "enable"))
    for _ in range(5):
        rclpy.spin_once(node, timeout_sec=0.1)
print(heard[-1:], [name for name, _ in node.get_topic_names_and_types() if name.startswith("/sher3/")])
"""


def test_options_of_ros_are_told_from_ours():
    assert split(["--rate", "5", "--ros-args", "-r", "__ns:=/left"]) == (
        ["--rate", "5"],
        ["--ros-args", "-r", "__ns:=/left"],
    )
    assert split(["--rate", "5"]) == (["--rate", "5"], [])


def test_every_node_is_a_program_of_the_package():
    tree = ast.parse((PACKAGE / "setup.py").read_text())
    (names,) = (
        ast.literal_eval(n.value) for n in tree.body if isinstance(n, ast.Assign) and n.targets[0].id == "NODES"
    )
    assert sorted(names) == sorted(NODES)
    for path in sorted((PACKAGE / "launch").glob("*.launch.py")):
        ast.parse(path.read_text())
        assert f"launch/{path.name}" in (PACKAGE / "setup.py").read_text()


@pytest.mark.graph
@pytest.mark.slow
@pytest.mark.flaky(reruns=2)
def test_a_robot_of_single_programs_runs_in_another_namespace(tmp_path):
    """Seven programs without `sher3 up`: the robot is enabled by a client in /left, and nothing is in /sher3."""
    domain = claim_domain(PROCESSES)
    processes = []
    script = "import sys; from sher3_bringup.processes.one_node import main; sys.argv[0] = sys.argv.pop(1); main()"
    try:
        for name in ("plant", "force_sensor", "pedal", "admittance", "kinematics", "motor_driver", "supervisor"):
            words = [name, "--patient", "--domain", str(domain), "--ros-args", "-r", "__ns:=/left"]
            processes.append(subprocess.Popen([sys.executable, "-c", script, *words], env=child_environment()))
            time.sleep(5.0 if name == "plant" else 0.0)
        result = subprocess.run(
            [sys.executable, "-c", HEAR, str(domain)], env=dict(os.environ), capture_output=True, text=True, timeout=120
        )
        assert result.stdout.strip() == "['ENABLED'] []", result.stdout + result.stderr
    finally:
        for process in processes:
            process.terminate()
        for process in processes:
            process.wait(20.0)
        release_domain(domain)
