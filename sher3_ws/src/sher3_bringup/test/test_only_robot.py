"""One robot to a domain, and no process that outlives its parent."""

import os
import signal
import subprocess
import sys
import time

import pytest
from sher3_bringup.errors import NOT_STARTED, AlreadyRunning
from sher3_bringup.processes.only_robot import only_robot
from sher3_runtime.process import ORPHAN_LIMIT


@pytest.mark.flaky(reruns=2)
def test_a_second_robot_in_a_domain_is_refused_and_named(tmp_path):
    with only_robot(7, tmp_path):
        with (
            pytest.raises(AlreadyRunning, match=rf"domain 7.*process {os.getpid()}") as refused,
            only_robot(7, tmp_path),
        ):
            pass
        with only_robot(8, tmp_path):
            pass
    assert refused.value.exit_code == NOT_STARTED
    with only_robot(7, tmp_path):
        pass


ORPHAN = """
import os, sys, time
from sher3_runtime.process import die_with_parent, stop_on_signals
parent = os.getpid()
if os.fork() == 0:
    {before}
    die_with_parent(parent)
    stop_on_signals()
    print(os.getpid(), flush=True)
    while True:  # deaf to its flag, as a process is that waits for ever inside the middleware
        time.sleep(0.01)
time.sleep(60)
"""


@pytest.mark.flaky(reruns=2)
def test_a_process_that_does_not_listen_ends_with_its_parent():
    """It has 100 ms; the process is looked for until then and 0.4 s more, for a busy machine."""
    parent = subprocess.Popen([sys.executable, "-c", ORPHAN.format(before="pass")], stdout=subprocess.PIPE)
    child = int(parent.stdout.readline())
    killed = time.monotonic()
    parent.send_signal(signal.SIGKILL)
    parent.wait()
    while _alive(child) and time.monotonic() < killed + ORPHAN_LIMIT + 0.4:
        time.sleep(0.002)
    assert not _alive(child)


def test_a_process_whose_parent_was_gone_before_it_asked_never_begins():
    before = "os.kill(parent, 9); time.sleep(0.05)"
    parent = subprocess.Popen([sys.executable, "-c", ORPHAN.format(before=before)], stdout=subprocess.PIPE)
    out, _ = parent.communicate(timeout=20)
    assert out == b""


def _alive(pid: int) -> bool:
    try:
        with open(f"/proc/{pid}/stat") as stat:
            return stat.read().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False
