"""`sher3 up` in processes of its own: the ready line, Ctrl-C, exit codes, and that nothing is left behind."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest
from processes import child_environment, sher3_command
from sher3_bags import recover
from sher3_bags.reading import read_run
from sher3_bringup.settings.run_settings import MOCK_FORCE_PORT

pytestmark = [pytest.mark.graph, pytest.mark.flaky(reruns=2)]
PATIENCE = 120.0
"""Longest start: a machine that has never compiled the kernels."""
RECORDED, A_FEW = 100_000, 20
"""Bytes of a recording that took place, 0.9 kB a tick beside what describes it; ticks that are in it at least."""


class Robot:
    """A running `sher3 up`; on mocks it is patient, since a busy computer is not what is asked about here."""

    def __init__(self, *arguments: str) -> None:
        self.process = subprocess.Popen(
            sher3_command("up", *arguments, *(() if "--real" in arguments else ("--patient",))),
            env=child_environment(),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def ready(self) -> str:
        """Return the ready line."""
        line = self.process.stdout.readline()
        assert line.startswith("ready"), line + self.process.stderr.read()
        return line

    def children(self) -> list[psutil.Process]:
        return psutil.Process(self.process.pid).children(recursive=True)

    def work(self, seconds: float) -> None:
        """Wait until its processes have had that much of the processor, which a busy computer gives them later."""
        children = self.children()
        begin, end = _processor_time(children), time.monotonic() + PATIENCE
        while _processor_time(children) < begin + seconds:
            assert time.monotonic() < end, "the robot's processes do not run"
            time.sleep(0.05)

    def records(self, folder: Path) -> None:
        """Wait until it has recorded something: beside a load of 23 that took ten times as much of the processor."""
        end = time.monotonic() + PATIENCE
        while sum(file.stat().st_size for file in folder.glob("*.mcap")) < RECORDED:
            assert time.monotonic() < end, "nothing is recorded"
            time.sleep(0.05)

    def finish(self) -> tuple[int, str, str]:
        out, err = self.process.communicate(timeout=PATIENCE)
        return self.process.returncode, out, err


def _processor_time(processes: list[psutil.Process]) -> float:
    return sum(sum(process.cpu_times()[:2]) for process in processes)


STRANGER = """
import rclpy
from sensor_msgs.msg import Joy
from std_msgs.msg import String
rclpy.init()
node, heard = rclpy.create_node("stranger"), []
command = node.create_publisher(String, "/sher3/state_command", 10)
node.create_subscription(String, "/sher3/operating_state", lambda message: heard.append(message.data), 10)
while "ENABLED" not in heard:
    command.publish(String(data="enable"))
    rclpy.spin_once(node, timeout_sec=0.2)
node.create_publisher(Joy, "/sher3/pedal/measured", 10)
rclpy.spin(node)
"""
"""Somebody who enables the robot and then publishes its own pedal stream beside it."""


@pytest.fixture
def robot(domain):
    started = []

    def start(*arguments: str) -> Robot:
        started.append(Robot("--domain", str(domain), "--realtime", "0", *arguments))
        return started[-1]

    yield start
    for robot in started:
        if robot.process.poll() is None:
            robot.process.kill()
            robot.process.communicate()


def test_ready_line_then_ctrl_c_stops_everything(robot, bag_folder):
    """One interrupt, exit code 0, no process left, and the recording is complete."""
    running = robot("--record", bag_folder)
    assert re.match(r"ready: 8 processes at 500 Hz on mocks in \d+\.\d\d s", running.ready())
    children = running.children()
    assert len(children) == 9, "the eight of the robot, and the terminal's listener"
    running.records(bag_folder)
    running.process.send_signal(signal.SIGINT)
    status, out, _ = running.finish()
    assert status == 0, out
    assert out.strip().endswith(f"stopped; recorded {bag_folder}")
    assert not [child for child in children if child.is_running() and child.status() != psutil.STATUS_ZOMBIE]
    run = read_run(bag_folder, check=False)
    assert len(run["measured_js"]) > A_FEW and len(run["force/measured_cf"]) > A_FEW


def test_nodes_can_share_processes_and_the_run_can_end_by_itself(robot):
    nodes = "plant,force_sensor+pedal,admittance+kinematics+motor_driver,supervisor"
    running = robot("--nodes", nodes, "--duration", "0.5")
    assert "4 processes" in running.ready()
    assert running.finish()[0] == 0


def test_the_loop_in_one_process_ends_as_one_and_stops_the_robot(robot):
    """Who shares a process ends with it; plant and supervisor are other processes."""
    running = robot("--layout", "composed", "--rate", "200")
    assert "3 processes" in running.ready()
    children = running.children()
    running.work(0.3)
    children[1].kill()
    status, _, err = running.finish()
    assert status == 4
    assert "force_sensor+pedal+admittance+kinematics+motor_driver stopped: killed by SIGKILL" in err
    assert not [child for child in children if child.is_running() and child.status() != psutil.STATUS_ZOMBIE]


def test_a_fault_is_said_as_it_happens_and_is_the_exit_code_unless_it_was_recovered(robot, domain):
    """Two nodes may not publish the pedal: the line says what to start instead."""
    running = robot("--layout", "composed")
    running.ready()
    with subprocess.Popen(
        [sys.executable, "-c", STRANGER], env=child_environment(ROS_DOMAIN_ID=str(domain))
    ) as stranger:
        said = [running.process.stdout.readline()]
        while "FAULT" not in said[-1]:
            said.append(running.process.stdout.readline())
        stranger.kill()
    told = [line for line in said if "refused" not in line]
    assert [line.split(maxsplit=2)[2] for line in told[:2]] == ["DISABLED  by start\n", "ENABLED  by enable\n"]
    assert "FAULT  PUBLISHED_TWICE pedal/measured: 2 publishers, limit 1 publishers" in told[2]
    assert "`--without pedal`" in told[2] and told[2].endswith("then send disable, and enable\n")
    running.process.send_signal(signal.SIGINT)
    status, _, err = running.finish()
    assert status == 6 and "sher3: the robot ended in FAULT PUBLISHED_TWICE" in err


def test_the_death_of_a_process_stops_the_robot(robot):
    running = robot()
    running.ready()
    children = running.children()
    children[3].kill()
    status, _, err = running.finish()
    assert status == 4
    assert re.search(r"sher3: \w+ stopped: killed by SIGKILL; the robot has been stopped", err)
    assert not [child for child in children if child.is_running() and child.status() != psutil.STATUS_ZOMBIE]


@pytest.mark.parametrize("required", [pytest.param(True, marks=pytest.mark.slow), False])
def test_the_death_of_the_recorder_stops_the_robot_unless_recording_is_optional(robot, bag_folder, tmp_path, required):
    """In both cases what it had written can be recovered."""
    running = robot("--record", bag_folder, *([] if required else ["--record-optional"]))
    running.ready()
    recorder = sorted(child.pid for child in running.children())[-2]  # the terminal's listener comes after it
    running.records(bag_folder)
    os.kill(recorder, signal.SIGKILL)
    line = next(line for line in running.process.stderr if line.startswith("sher3: recorder stopped: "))
    if required:
        assert line == "sher3: recorder stopped: killed by SIGKILL; the robot has been stopped\n"
        assert running.finish()[0] == 4
    else:
        assert line == "sher3: recorder stopped: killed by SIGKILL; the robot goes on without it\n"
        running.work(0.3)
        running.process.send_signal(signal.SIGINT)
        assert running.finish()[0] == 0
    assert len(read_run(recover(bag_folder, tmp_path / "recovered").target, check=False)["measured_js"]) > A_FEW


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("--can", "socketcan:nocan0", "--can", "socketcan:nocan1", "--nodes", "motor_driver"), "socketcan:nocan0"),
        (("--can", "a", "--can", "b", "--nodes", "pedal", "--pedal-device", "/dev/hidraw99"), "/dev/hidraw99"),
        (("--can", "a", "--can", "b", "--nodes", "force_sensor", "--force-device", "127.0.0.1:9"), "127.0.0.1:9"),
    ],
)
def test_a_missing_device_is_exit_code_3_and_a_sentence(robot, arguments, sentence):
    status, _, err = robot("--real", *arguments).finish()
    assert status == 3
    (line,) = [line for line in err.splitlines() if line.startswith("sher3: ")]
    assert sentence in line


def test_a_second_robot_on_the_same_domain_is_refused(robot, domain):
    """Two mocks would share their devices; the port of the force sensor tells."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", MOCK_FORCE_PORT + 250 * domain))
        status, _, err = robot().finish()
    assert status == 3
    assert "plant: mock netft 127.0.0.1" in err


def test_interrupt_during_start_up_is_clean(robot):
    running = robot()
    deadline = time.monotonic() + PATIENCE
    while not running.children() and time.monotonic() < deadline:
        time.sleep(0.01)
    running.process.send_signal(signal.SIGINT)
    status, _, err = running.finish()
    assert status in (0, 130), err
    assert "Traceback" not in err


def test_nothing_is_left_in_shared_memory(robot):
    before = set(os.listdir("/dev/shm")) if Path("/dev/shm").is_dir() else set()
    running = robot("--duration", "0.3")
    running.ready()
    running.finish()
    assert not {name for name in set(os.listdir("/dev/shm")) - before if name.startswith(("fastrtps", "fastdds"))}
