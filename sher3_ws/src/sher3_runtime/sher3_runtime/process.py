"""The life of one process of the graph: set up, meet the others, start on the same tick, run, report how it ended.

With a control socket (from `sher3 up`) the process takes part in the start barrier: it sends what it publishes and
subscribes to, learns how many partners each topic has, waits until it has found them all, and starts at the stamp that
all processes are given. So no cycle is lost at the start.
"""

from __future__ import annotations

import ctypes
import json
import os
import signal
import socket
import time
from collections.abc import Callable, Sequence
from contextlib import suppress

import rclpy
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from sher3_description import Sher3Error

from .ports import clock_of, ports
from .spinning import close, spin

REALTIME_VARIABLE = "SHER3_REALTIME"
CONTROL_VARIABLE = "SHER3_CONTROL_FD"
_PR_SET_PDEATHSIG = 1


class NotStarted(Sher3Error):
    """The processes of the graph did not find each other in time."""


def run(make_nodes: Callable[[], Sequence[Node]]) -> None:
    """Make nodes and run them until they are told to stop.

    Raises:
        Exception: what making or running a node raises; the other end of the control socket has been told.
    """
    control = _control_socket()
    die_with_parent()
    use_realtime(int(os.environ.get(REALTIME_VARIABLE) or 0))
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    stop = stop_on_signals()
    nodes: Sequence[Node] = ()
    try:
        try:
            nodes = make_nodes()
            if control is not None:
                _meet(nodes, control)
        except BaseException:
            close(nodes)
            raise
        spin(nodes, stop=stop)
    except Exception as error:
        if control is not None:
            with suppress(OSError):
                _send(control, {"failure": f"{error}", "kind": type(error).__name__})
        raise
    finally:
        rclpy.try_shutdown()


def stop_on_signals() -> Callable[[], bool]:
    """Turn SIGINT and SIGTERM into a flag, so that nodes are closed between two callbacks and never inside one."""
    caught: list[int] = []
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda received, _: caught.append(received))
    return lambda: bool(caught)


def die_with_parent() -> None:
    """Ask for a SIGTERM when the parent dies (Linux only), so that nothing runs on unsupervised."""
    with suppress(OSError, AttributeError):
        ctypes.CDLL(None, use_errno=True).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM, 0, 0, 0)


def use_realtime(priority: int) -> bool:
    """Put this process under SCHED_FIFO; threads started later (the middleware's) inherit it. Return whether it worked."""
    if priority <= 0:
        return False
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
    except (OSError, AttributeError):
        return False
    return True


def realtime_permitted() -> bool:
    """Tell whether this user may use SCHED_FIFO."""
    policy, parameter = os.sched_getscheduler(0), os.sched_getparam(0)
    if not use_realtime(1):
        return False
    os.sched_setscheduler(0, policy, parameter)
    return True


def _control_socket() -> socket.socket | None:
    number = os.environ.pop(CONTROL_VARIABLE, "")
    return socket.socket(fileno=int(number)) if number else None


def _send(control: socket.socket, data: dict[str, object]) -> None:
    control.sendall(json.dumps(data).encode() + b"\n")


def _meet(nodes: Sequence[Node], control: socket.socket, patience: float = 30.0) -> None:
    """Take part in the start barrier."""
    publishers = [(name, pub) for node in nodes for name, pub in ports(node).publishers.items()]
    subscribers = [(name, sub) for node in nodes for name, sub in ports(node).subscriptions.items()]
    _send(control, {"publishes": [name for name, _ in publishers], "subscribes": [name for name, _ in subscribers]})
    control.settimeout(patience)
    answers = control.makefile("r")
    expected = json.loads(answers.readline() or "{}")
    deadline = time.monotonic() + patience
    missing = ["everything"]
    while missing:
        missing = [n for n, p in publishers if p.get_subscription_count() < expected["subscribers"].get(n, 0)]
        missing += [n for n, s in subscribers if s.handle.get_publisher_count() < expected["publishers"].get(n, 0)]
        if time.monotonic() > deadline:
            remedy = "check that nothing filters UDP on the loopback interface"
            raise NotStarted("partners not found on", value=sorted(set(missing)), limit=f"{patience} s", remedy=remedy)
        time.sleep(0.002)
    _send(control, {"matched": True})
    start = json.loads(answers.readline() or "{}")
    for node in nodes:
        clock_of(node).start_ns = start["start_ns"]
    control.settimeout(None)
