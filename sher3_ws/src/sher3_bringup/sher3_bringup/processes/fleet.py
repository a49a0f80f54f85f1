"""Starting, watching and stopping the processes of a graph.

Every process is a fork of this one after the heavy imports, so that a graph of eight is up in a second. They start
their first tick together (see `sher3_runtime.process`); when one of them ends by itself, all are stopped, the drives
first.
"""

from __future__ import annotations

import json
import os
import selectors
import signal
import socket
import sys
import time
import traceback
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from sher3_common import Sher3Error
from sher3_runtime.clock import OFFSET_VARIABLE, system_offset
from sher3_runtime.composed.ring import Ring
from sher3_runtime.process import CONTROL_VARIABLE, CORE_VARIABLE, REALTIME_VARIABLE, die_with_parent, run

from sher3_bringup.errors import NotStopped, ProcessDied, StartError

STOP_ORDER = (("motor_driver",), (), ("plant", "recorder"))
"""Who is stopped first and last; the rest in between."""
STOPS = frozenset({signal.SIGTERM, signal.SIGINT})
"""Signals that end a process, also one that has only just been forked."""


@dataclass
class Member:
    """One process of the graph."""

    name: str
    pid: int
    control: socket.socket
    messages: list[dict] = field(default_factory=list)
    buffer: bytes = b""
    status: int | None = None

    def send(self, data: dict) -> None:
        """Send one line to the process."""
        self.control.sendall(json.dumps(data).encode() + b"\n")

    def read(self) -> bool:
        """Take what the process has sent; return False when it has closed its end."""
        chunk = self.control.recv(65536)
        *lines, self.buffer = (self.buffer + chunk).split(b"\n")
        self.messages += [json.loads(line) for line in lines]
        return bool(chunk)

    def said(self, key: str) -> dict:
        """Return the first message with `key`, an empty one when there is none."""
        return next((message for message in self.messages if key in message), {})

    def poll(self) -> int | None:
        """Return the exit status once the process has ended."""
        if self.status is None:
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                self.status = os.waitstatus_to_exitcode(status)
        return self.status

    @property
    def failure(self) -> str:
        """Why the process ended, in a sentence."""
        if failure := self.said("failure"):
            return str(failure["failure"])
        if self.status is not None and self.status < 0:
            return f"killed by {signal.Signals(-self.status).name}"
        return f"ended with exit status {self.status}"


class Fleet:
    """The processes of a graph; use it as a context manager, which stops them."""

    def __init__(self) -> None:
        self.members: list[Member] = []
        os.environ[OFFSET_VARIABLE] = str(system_offset())

    def launch(
        self,
        name: str,
        make_nodes: Callable[[], Any],
        realtime: int = 0,
        together: bool = False,
        ring: Ring | None = None,
        core: int | None = None,
    ) -> Member:
        """Fork a process that makes and runs nodes, under SCHED_FIFO from its first tick on (see `use_realtime`).

        With `together` its nodes hear each other within the process, and `ring` is for those beside it that look at
        their own pace. Under SCHED_FIFO it keeps to `core`, where one is given.
        """
        ours, theirs = socket.socketpair()
        sys.stdout.flush()
        sys.stderr.flush()
        parent = os.getpid()
        with _blocked(STOPS):
            pid = os.fork()
            if pid == 0:
                for number in STOPS:  # the parent's handlers would only make a note of it
                    signal.signal(number, signal.SIG_DFL)
        if pid == 0:
            die_with_parent(parent)
            os.environ[REALTIME_VARIABLE] = str(realtime)
            os.environ[CORE_VARIABLE] = "" if core is None else str(core)
            others = [ours, *(member.control for member in self.members)]
            _child(partial(run, make_nodes, together, ring), theirs, others)
        theirs.close()
        ours.setblocking(False)
        member = Member(name, pid, ours)
        self.members.append(member)
        return member

    def start(self, patience: float = 60.0, lead: float = 0.1) -> float:
        """Bring all processes to the same first tick; return the seconds it took.

        Raises:
            StartError: a process failed, or they did not find each other within `patience` s.
        """
        begin = time.monotonic()
        offers = self.gather("publishes", patience)
        topics = {key: [name for offer in offers for name in offer[key]] for key in ("publishes", "subscribes")}
        publishers, subscribers = (
            {name: names.count(name) for name in names} for names in (topics["publishes"], topics["subscribes"])
        )
        self._tell({"publishers": publishers, "subscribers": subscribers})
        self.gather("matched", patience)
        self._tell({"start_ns": time.monotonic_ns() + int(os.environ[OFFSET_VARIABLE]) + round(lead * 1e9)})
        return time.monotonic() - begin

    def watch(self, until: Callable[[], object], interval: float = 0.05, spare: Collection[str] = ()) -> None:
        """Return when `until()` is true; the end of a process named in `spare` is only said on standard error.

        Raises:
            ProcessDied: another process ended before.
        """
        lost: set[str] = set()
        while not until():
            for member in self.members:
                self._drain(member)
                if member.poll() is None or member.name in lost:
                    continue
                if member.name not in spare:
                    raise ProcessDied(f"{member.name} {_ended(member)}", remedy="the robot has been stopped")
                lost.add(member.name)
                print(f"sher3: {member.name} {_ended(member)}; the robot goes on without it", file=sys.stderr)
            time.sleep(interval)

    def stop(self, patience: float = 5.0) -> None:
        """Stop every process, the drives first.

        Raises:
            NotStopped: a process had to be killed.
        """
        first, _, last = STOP_ORDER
        killed = []
        stages = [
            [m for m in self.members if set(m.name.split("+")) & set(first)],
            [m for m in self.members if not set(m.name.split("+")) & {*first, *last}],
            [m for m in self.members if set(m.name.split("+")) & set(last)],
        ]
        for stage in stages:
            for member in stage:
                if member.poll() is None:
                    os.kill(member.pid, signal.SIGTERM)
            deadline = time.monotonic() + patience
            while (alive := [m for m in stage if m.poll() is None]) and time.monotonic() < deadline:
                time.sleep(0.005)
            for member in alive:
                os.kill(member.pid, signal.SIGKILL)
                os.waitpid(member.pid, 0)
                member.status = -signal.SIGKILL
                killed.append(member.name)
        for member in self.members:
            self._drain(member)
            member.control.close()
        if killed:
            raise NotStopped("processes killed", value=", ".join(killed), limit=f"{patience} s", remedy="look at why")

    def __enter__(self) -> Fleet:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        try:
            self.stop()
        except NotStopped as error:
            if kind is None:
                raise
            print(f"sher3: {error}", file=sys.stderr)

    def _drain(self, member: Member) -> None:
        try:
            while member.read():
                pass
        except (BlockingIOError, OSError):
            pass

    def _tell(self, data: dict) -> None:
        for member in self.members:
            member.send(data)

    def gather(self, key: str, patience: float = 60.0) -> list[dict]:
        """Wait for a message with `key` from every process launched so far: `publishes` means that its nodes exist.

        Raises:
            StartError: a process failed or did not answer within `patience` s.
        """
        deadline = time.monotonic() + patience
        waiting = list(self.members)
        with selectors.DefaultSelector() as selector:
            for member in waiting:
                selector.register(member.control, selectors.EVENT_READ, member)
            while waiting := [member for member in waiting if not member.said(key)]:
                for ready, _ in selector.select(0.1):
                    if not ready.data.read():
                        selector.unregister(ready.data.control)
                for member in self.members:
                    if member.said("failure"):
                        raise StartError(f"{member.name}: {member.failure}")
                for member in waiting:
                    if not member.said(key) and member.poll() is not None:
                        raise StartError(f"{member.name} {_ended(member)}")
                if time.monotonic() > deadline:
                    raise StartError("no answer", value=", ".join(m.name for m in waiting), limit=f"{patience} s")
        return [member.said(key) for member in self.members]


@contextmanager
def _blocked(signals: Collection[signal.Signals]) -> Iterator[None]:
    """Hold signals back: they come at the end of the block."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, signals)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _ended(member: Member) -> str:
    return f"stopped: {member.failure}"


def _child(run_nodes: Callable[[], None], control: socket.socket, not_mine: Sequence[socket.socket]) -> None:
    """Be one process of the graph; never returns."""
    status = 1
    try:
        os.setsid()
        for other in not_mine:
            other.close()
        os.environ[CONTROL_VARIABLE] = str(control.detach())
        run_nodes()
        status = 0
    except Sher3Error:
        # The sentence has gone to the supervising process, which prints it.
        status = 1
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)
