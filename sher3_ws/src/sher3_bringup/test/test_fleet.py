"""Supervision of processes, with small nodes of its own in processes of their own."""

import subprocess
import sys
import textwrap
import time
from pathlib import Path

import pytest
from sher3_runtime.domains import PROCESSES, claim_domain, release_domain
from sher3_runtime.environment import child_environment

pytestmark = [pytest.mark.graph, pytest.mark.flaky(reruns=2)]

HEAD = """
import os, signal, sys, time
from sher3_runtime import environment
environment.apply(int(sys.argv[1]))
from rclpy.node import Node
from sher3_bringup.errors import NotStopped, ProcessDied, StartError
from sher3_bringup.processes.fleet import Fleet
from sher3_common import Sher3Error
from sher3_common.samples import WrenchSample
from sher3_runtime import NODE_OPTIONS, advertise, on_tick, subscribe

class Source(Node):
    def __init__(self):
        super().__init__("source", **NODE_OPTIONS)
        self.publish = advertise(self, "force/measured_cf")
        on_tick(self, lambda stamp: self.publish(WrenchSample(stamp, (0.0,) * 6)))

class Sink(Node):
    def __init__(self, path):
        super().__init__("sink", **NODE_OPTIONS)
        self.stamps, self.path = [], path
        subscribe(self, "force/measured_cf", lambda sample: self.stamps.append(sample.stamp))
    def close(self):
        with open(self.path, "w") as file:
            file.write(" ".join(map(str, self.stamps)))
"""


def run(body: str, *arguments: str) -> subprocess.CompletedProcess:
    """Run a script: forking belongs in a process without ROS threads."""
    domain, script = claim_domain(PROCESSES), HEAD + textwrap.dedent(body)
    command = [sys.executable, "-W", "error:This process:DeprecationWarning", "-c", script, str(domain), *arguments]
    result = subprocess.run(command, env=child_environment(), capture_output=True, text=True, timeout=60)
    release_domain(domain)
    return result


def test_all_start_on_one_tick_and_no_sample_is_lost(tmp_path):
    """The start barrier: the first sample of the source is the first the sink gets, and none is missing."""
    result = run(
        """
        with Fleet() as fleet:
            fleet.launch("sink", lambda: [Sink(sys.argv[2])])
            fleet.launch("source", lambda: [Source()])
            fleet.start()
            end = time.monotonic() + 1.0
            fleet.watch(lambda: time.monotonic() > end)
        """,
        str(tmp_path / "stamps"),
    )
    assert result.returncode == 0, result.stderr
    stamps = [int(word) for word in (tmp_path / "stamps").read_text().split()]
    assert len(stamps) > 100
    assert all(stamp % 2_000_000 == 0 for stamp in stamps)


def test_a_failing_start_says_why_and_leaves_nothing(tmp_path):
    result = run(
        """
        def broken():
            raise Sher3Error("no device", value="/dev/none", remedy="plug it in")
        try:
            with Fleet() as fleet:
                fleet.launch("source", lambda: [Source()])
                fleet.launch("pedal", broken)
                fleet.start()
        except StartError as error:
            print(error, [member.poll() is not None for member in fleet.members])
        """
    )
    assert result.stdout == "pedal: no device; value /dev/none; plug it in [True, True]\n", result.stderr


@pytest.mark.parametrize(("death", "why"), [("os.kill(os.getpid(), 9)", "SIGKILL"), ("1 / 0", "division by zero")])
def test_a_death_stops_the_others(death, why):
    result = run(
        f"""
        class Mortal(Source):
            def __init__(self):
                super().__init__()
                on_tick(self, lambda stamp: {death}, every=50)
        try:
            with Fleet() as fleet:
                fleet.launch("source", lambda: [Source()])
                fleet.launch("mortal", lambda: [Mortal()])
                fleet.start()
                fleet.watch(lambda: False)
        except ProcessDied as error:
            print(error, fleet.members[0].poll())
        """
    )
    assert result.stdout.startswith("mortal stopped: ") and why in result.stdout, result.stderr
    assert result.stdout.endswith("the robot has been stopped 0\n")


def test_a_process_that_does_not_stop_is_killed_and_named():
    result = run(
        """
        class Stubborn(Source):
            def close(self):
                time.sleep(30.0)
        try:
            fleet = Fleet()
            fleet.launch("stubborn", lambda: [Stubborn()])
            fleet.start()
            fleet.stop(patience=0.5)
        except NotStopped as error:
            print(error, error.exit_code)
        """
    )
    assert result.stdout.startswith("processes killed; value stubborn; limit 0.5 s") and result.stdout.endswith("5\n")


def test_children_do_not_outlive_their_parent():
    result = run(
        """
        fleet = Fleet()
        member = fleet.launch("source", lambda: [Source()])
        fleet.gather("publishes")
        print(member.pid, flush=True)
        os._exit(0)
        """
    )
    pid = int(result.stdout)
    deadline = time.monotonic() + 10.0
    state = Path(f"/proc/{pid}/stat")
    while state.exists() and state.read_text().split()[2] != "Z":
        assert time.monotonic() < deadline
        time.sleep(0.01)


def test_every_socket_is_bound_to_the_loopback_interface():
    """What the processes open, as the kernel lists it: 127.0.0.1, or the multicast group joined on it."""
    result = run(
        """
        with Fleet() as fleet:
            member = fleet.launch("source", lambda: [Source()])
            fleet.gather("publishes")
            inodes = set()
            for name in os.listdir(f"/proc/{member.pid}/fd"):
                try:
                    target = os.readlink(f"/proc/{member.pid}/fd/{name}")
                except OSError:
                    continue
                if target.startswith("socket:["):
                    inodes.add(target[8:-1])
            for table in ("udp", "udp6", "tcp", "tcp6"):
                for line in open(f"/proc/{member.pid}/net/{table}").read().splitlines()[1:]:
                    words = line.split()
                    if words[9] in inodes:
                        print(table, words[1].split(":")[0])
        """
    )
    addresses = {tuple(line.split()) for line in result.stdout.splitlines()}
    assert ("udp", "0100007F") in addresses, result.stderr
    assert addresses <= {("udp", "0100007F"), ("udp", "0100FFEF")}, addresses


def test_a_process_that_has_only_just_been_forked_is_stopped_at_once():
    """The handlers of its parent, which would only make a note of the signal, are not its own.

    It stays before the handlers of its own, however late the signal comes on a busy computer.
    """
    result = run(
        """
        from sher3_bringup.processes import fleet as module
        module.run = lambda *_: time.sleep(30)
        signal.signal(signal.SIGTERM, lambda *_: None)
        with Fleet() as fleet:
            fleet.launch("slow", lambda: [])
            fleet.stop(patience=10.0)
        """
    )
    assert result.returncode == 0, result.stderr
