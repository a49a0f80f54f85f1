"""A process whose middleware does not let it go ends all the same, after its nodes are closed."""

from __future__ import annotations

import signal
import subprocess
import sys
import time

import pytest
from sher3_runtime import process
from sher3_runtime.domains import own_domain
from sher3_runtime.environment import child_environment, graph_environment

STUCK = """
from rclpy.node import Node
from sher3_runtime import process
from sher3_runtime.ports import NODE_OPTIONS

class Stuck(Node):
    def __init__(self):
        super().__init__("stuck", **NODE_OPTIONS)

    def close(self):
        print("closed", flush=True)
        raise RuntimeError("its device is gone")

    def destroy_node(self):
        import ctypes
        ctypes.PyDLL(None).pause()  # holds the interpreter's lock: no Python code runs any more

import os, signal, threading
threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGTERM)).start()
process.run(lambda: [Stuck()])
"""


@pytest.mark.flaky(reruns=2)
def test_a_farewell_that_does_not_end_is_cut_short():
    begin = time.monotonic()
    environment = child_environment(**graph_environment(own_domain()))
    done = subprocess.run([sys.executable, "-c", STUCK], env=environment, capture_output=True, text=True, timeout=30)
    assert done.stdout == "closed\n"
    assert done.returncode == -signal.SIGALRM
    assert time.monotonic() - begin > process.LEAVE_LIMIT
