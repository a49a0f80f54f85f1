"""The life of one process of the graph: set up, meet the others, start on the same tick, run, report how it ended.

With a control socket (from `sher3 up`) the process takes part in the start barrier. It sends the names of the topics it
publishes and subscribes to, is told how many partners each topic has, waits until it has found them all, and starts at
the stamp that all processes are given. So no cycle is lost at the start.
"""

from __future__ import annotations

import ctypes
import inspect
import json
import os
import signal
import socket
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext, suppress

import rclpy
from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from sher3_common import Sher3Error

from sher3_runtime.clock import NEVER_NS
from sher3_runtime.composed.composition import Composition
from sher3_runtime.composed.ring import Ring
from sher3_runtime.execution.spinning import spin
from sher3_runtime.ports import clock_of, ports

REALTIME_VARIABLE = "SHER3_REALTIME"
CORE_VARIABLE = "SHER3_CORE"
CONTROL_VARIABLE = "SHER3_CONTROL_FD"
LEAVE_LIMIT = 1.0
"""Time [s] that the middleware has to leave the graph; it needs milliseconds if it succeeds at all."""
ORPHAN_LIMIT = 0.1
"""Seconds after which the kernel ends a process whose parent has died. Braking at the drives' own ramp takes 15 ms of
them; the rest is for the loop to notice."""
_PR_SET_PDEATHSIG = 1


class NotStarted(Sher3Error):
    """The processes of the graph did not find each other in time."""


def run(make_nodes: Callable[[], Sequence[Node]], together: bool = False, ring: Ring | None = None) -> None:
    """Make nodes and run them until they are told to stop; the process must end soon after (see `leave_in_time`).

    Args:
        make_nodes: returns the nodes.
        together: they hear each other within the process, see `composition`.
        ring: then, for those beside the process that look at their own pace.

    Raises:
        Exception: Whatever making or running a node raises; the supervising process has been told by then.
    """
    control = _control_socket()
    die_with_parent()
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    stop = stop_on_signals()
    try:
        with Composition(ring) if together else nullcontext():
            nodes = make_nodes()
        make_logging_prompt()
        barrier = None if control is None else Barrier(nodes, control, stop)

        def meet(executor: Executor) -> None:
            if barrier is not None:
                barrier(executor)
            # Not earlier: what start-up costs would use up the share of the processor that the kernel leaves to FIFO.
            if use_realtime(int(os.environ.get(REALTIME_VARIABLE) or 0)) and (core := os.environ.get(CORE_VARIABLE)):
                keep_to(int(core))

        spin(nodes, stop=stop, meet=meet, leave=leave_in_time)
    except Exception as error:
        if control is not None:
            with suppress(OSError):
                _send(control, {"failure": f"{error}", "kind": type(error).__name__})
        raise
    finally:
        rclpy.try_shutdown()


def leave_in_time() -> None:
    """Let the kernel end this process `LEAVE_LIMIT` s from now; called when all nodes are closed already.

    Now and then a DDS participant, while it is destroyed, waits for ever for a thread of its own. No Python code runs
    then, so no Python code could end the process.
    """
    _end_within(LEAVE_LIMIT)


def _end_within(seconds: float) -> None:
    """Let the kernel end this process in `seconds`, or sooner where that is settled already."""
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    before, _ = signal.getitimer(signal.ITIMER_REAL)
    signal.setitimer(signal.ITIMER_REAL, min(seconds, before or seconds))


def make_logging_prompt() -> None:
    """Log one line now: the first line would otherwise delay the loop by 60 to 110 ms, which stops the robot.

    rclpy asks `inspect` which code logs, and `inspect` then looks at the file of every imported module, once.
    """
    inspect.getmodule(inspect.currentframe())


def stop_on_signals() -> Callable[[], bool]:
    """Turn SIGINT and SIGTERM into a flag, so that nodes are closed between two callbacks and never inside one.

    A process whose parent has died in the meantime closes its nodes too, but has `ORPHAN_LIMIT` s for it.
    """
    caught: list[int] = []
    parent = os.getppid()

    def catch(received: int, _: object) -> None:
        caught.append(received)
        if os.getppid() != parent:
            _end_within(ORPHAN_LIMIT)

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, catch)
    return lambda: bool(caught)


def die_with_parent(parent: int | None = None) -> None:
    """Ask for a SIGTERM when the parent dies (Linux only), so that nothing runs on unsupervised.

    Args:
        parent: process id of the parent where it was forked; a process whose parent died before it could ask ends here.
    """
    with suppress(OSError, AttributeError):
        ctypes.CDLL(None, use_errno=True).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM, 0, 0, 0)
    if parent is not None and os.getppid() != parent:
        os._exit(1)


def use_realtime(priority: int) -> bool:
    """Put the threads of this process under SCHED_FIFO; return whether the kernel permitted it.

    Args:
        priority: Priority of all threads; 0 changes nothing. A negative number gives its magnitude to the threads of
            the middleware only: they take what comes in while the main thread does what must not delay other processes.
    """
    if priority == 0:
        return False
    try:
        for thread in map(int, os.listdir("/proc/self/task")):
            if priority > 0 or thread != os.getpid():
                os.sched_setscheduler(thread, os.SCHED_FIFO, os.sched_param(abs(priority)))
    except (OSError, AttributeError):
        return False
    return True


def keep_to(core: int) -> None:
    """Keep the threads of this process to one core, where the kernel permits it (Linux only)."""
    with suppress(OSError, AttributeError):
        for thread in map(int, os.listdir("/proc/self/task")):
            os.sched_setaffinity(thread, {core})


def realtime_permitted() -> bool:
    """Tell whether this user may use SCHED_FIFO."""
    try:
        policy, parameter = os.sched_getscheduler(0), os.sched_getparam(0)
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
        os.sched_setscheduler(0, policy, parameter)
    except (OSError, AttributeError):
        return False
    return True


def _control_socket() -> socket.socket | None:
    number = os.environ.pop(CONTROL_VARIABLE, "")
    return socket.socket(fileno=int(number)) if number else None


def _send(control: socket.socket, data: Mapping[str, object]) -> None:
    control.sendall(json.dumps(data).encode() + b"\n")


class Barrier:
    """The part of this process in the start barrier; files and services are served meanwhile, ticks wait.

    Args:
        nodes: Nodes of this process.
        control: Socket to the supervising process.
        stop: Returns true when the process has been told to stop.
        patience: Time to wait for the others [s].
    """

    def __init__(
        self, nodes: Sequence[Node], control: socket.socket, stop: Callable[[], bool], patience: float = 60.0
    ) -> None:
        self._nodes, self._control, self._stop = nodes, control, stop
        self._deadline = time.monotonic() + patience
        self._buffer = b""

    def __call__(self, executor: Executor) -> None:
        """Meet the others.

        Raises:
            NotStarted: partners are missing at the end of the patience.
        """
        for node in self._nodes:
            clock_of(node).start_ns = NEVER_NS
        publishers = [(name, pub) for node in self._nodes for name, pub in ports(node).publishers.items()]
        subscribers = [(name, sub) for node in self._nodes for name, sub in ports(node).subscriptions.items()]
        offer = {"publishes": [name for name, _ in publishers], "subscribes": [name for name, _ in subscribers]}
        _send(self._control, offer)
        self._control.setblocking(False)
        expected = self._receive(executor)
        missing = ["anyone"] if expected else []
        while missing and not self._stop():
            missing = [n for n, p in publishers if p.get_subscription_count() < expected["subscribers"].get(n, 0)]
            missing += [n for n, s in subscribers if s.handle.get_publisher_count() < expected["publishers"].get(n, 0)]
            self._spin(executor, f"partners on {', '.join(sorted(set(missing)))}")
        _send(self._control, {"matched": True})
        start = self._receive(executor)
        for node in self._nodes:
            clock_of(node).start_ns = start.get("start_ns", NEVER_NS)
            for tick in ports(node).ticks:
                tick.schedule()
        executor.wake()

    def _receive(self, executor: Executor) -> dict:
        """Return the next line of the supervising process, or an empty one when this process has to stop."""
        while not self._stop():
            with suppress(BlockingIOError):
                chunk = self._control.recv(65536)
                if not chunk:
                    raise NotStarted("the supervising process is gone")
                self._buffer += chunk
            line, found, self._buffer = self._buffer.partition(b"\n")
            if found:
                return json.loads(line)
            self._buffer = line
            self._spin(executor, "a word of the supervising process")
        return {}

    def _spin(self, executor: Executor, awaited: str) -> None:
        executor.spin_once(0.002)
        if time.monotonic() > self._deadline:
            load = f"{os.getloadavg()[0]:.1f} on {os.cpu_count()} processors"
            remedy = f"end what else keeps the computer busy (load {load}), or see that nothing filters UDP on loopback"
            raise NotStarted(f"waited in vain for {awaited}", remedy=remedy)
