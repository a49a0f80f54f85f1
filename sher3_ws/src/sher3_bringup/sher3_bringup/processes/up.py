"""`sher3 up`: start the processes of a run, say when they are ready, keep them together, stop them."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from types import FrameType

from sher3_common.interrupts import interrupt
from sher3_common.progress import Say, silent
from sher3_runtime import environment
from sher3_runtime.composed.ring import Ring, share
from sher3_runtime.ports import PERIOD_VARIABLE
from sher3_runtime.process import make_logging_prompt, realtime_permitted

from sher3_bringup.errors import NoRealtime
from sher3_bringup.processes.fleet import Fleet
from sher3_bringup.processes.nodes import make_nodes, preload
from sher3_bringup.processes.only_robot import only_robot
from sher3_bringup.settings.run_settings import UNHURRIED, RunSettings
from sher3_bringup.terminal.beside import NAME, Beside

DEFAULT_REALTIME = 40
CHAIN = frozenset({"force_sensor", "admittance", "kinematics", "motor_driver"})
BESIDE = frozenset({"pedal", "supervisor"})
BESIDE_BY = 10
"""By how much the priority of a process beside the chain from force sample to CAN frame is lower than the chain's."""


def run_graph(
    settings: RunSettings,
    say: Say = print,
    extra: Mapping[str, Callable[[], object]] | None = None,
    progress: Callable[[float], None] | None = None,
    status: Say = silent,
) -> str:
    """Run the graph until Ctrl-C, SIGTERM or the end of its duration; say each change of state and each refusal.

    Args:
        settings: of the run, checked.
        say: prints a line.
        extra: further processes by name, each given by what makes its nodes.
        progress: called every 50 ms with the seconds since the first tick.
        status: takes the status line, as often.

    Returns:
        The fault that the robot was in at the end, as one line; empty where it was in none.

    Raises:
        AlreadyRunning, NoRealtime, StartError, ProcessDied, NotStopped: see `errors`; whatever was running has been
            stopped.
    """
    begin, caught = time.monotonic(), list[int]()
    with only_robot(settings.domain), _signals(lambda number, _: caught.append(number)), Fleet() as fleet:
        realtime = prepare(settings)
        launch_nodes(fleet, settings, realtime)
        for name, make in (extra or {}).items():
            fleet.launch(name, make, beside(realtime))
        processes, terminal = len(fleet.members), Beside(say, status)
        fleet.launch(NAME, terminal.make_nodes)
        fleet.start()
        terminal.begin()
        started = time.monotonic()
        say(
            f"ready: {processes} processes at {settings.rate:g} Hz on "
            f"{'mocks' if settings.mock else 'hardware'} in {started - begin:.2f} s; Ctrl-C stops"
        )

        def finished() -> bool:
            terminal.look()
            elapsed = time.monotonic() - started
            if progress is not None:
                progress(elapsed)
            return bool(caught) or (settings.duration is not None and elapsed >= settings.duration)

        try:
            fleet.watch(finished, spare=(NAME, *(("recorder",) if settings.recording == "optional" else ())))
        finally:
            terminal.end()
    say("stopped" + (f"; recorded {settings.record}" if settings.record else ""))
    return terminal.news.fault


def launch_nodes(fleet: Fleet, settings: RunSettings, realtime: int, patience: float = 60.0) -> None:
    """Launch the processes of a run, the chain at priority `realtime`; wait at most `patience` s for the plant's nodes.

    Devices are there before their drivers look for them. While the plant's process starts, this one imports what the
    others share.

    Raises:
        StartError: the plant's process failed, or did not answer in time.
        KeyboardInterrupt: SIGINT or SIGTERM came while the nodes were compiled.
    """
    processes = launch_order(settings.processes)
    rings = {process: Ring() for process in processes if len(process) > 1}
    share(rings.values())
    for devices in (True, False):
        group = [process for process in processes if ("plant" in process) is devices]
        with _signals(interrupt):  # on a new machine it compiles for a minute
            preload(settings, [name for process in group for name in process])
        if not devices:
            make_logging_prompt()  # for all processes but the plant's, which does it meanwhile
            fleet.gather("publishes", patience)
        for process in group:
            make, first = partial(make_nodes, settings, process), priority(process, realtime)
            ring, core = rings.get(process), shared_core(process, processes)
            fleet.launch("+".join(process), make, first, len(process) > 1, ring, core)
    share(())


def priority(process: Sequence[str], realtime: int) -> int:
    """Return the priority of a process, as `use_realtime` takes it, where the chain has `realtime`.

    Recorder and gap monitor have none: compressing a chunk at the priority of the loop would hold the loop up. Only
    their receiving threads have it.
    """
    if set(process) <= UNHURRIED:
        return -realtime
    return beside(realtime) if set(process) <= BESIDE else realtime


def beside(realtime: int) -> int:
    """Return the priority of a process beside a chain of priority `realtime`; 0 stays 0."""
    return min(realtime, max(1, realtime - BESIDE_BY))


def shared_core(process: Sequence[str], processes: Sequence[tuple[str, ...]]) -> int | None:
    """Return the core that a process keeps to, the last one; None where it may run on all.

    The plant and a loop in one process take turns: each sends and waits for the other. On one core neither wakes an
    idle one, which costs more than what it has to do, and the other cores are left to everybody else.
    """
    cores: set[int] = getattr(os, "sched_getaffinity", lambda _: set())(0)
    joined = [other for other in processes if set(other) >= CHAIN or other == ("plant",)]
    return max(cores) if len(cores) > 1 and len(joined) > 1 and process in joined else None


def launch_order(processes: Sequence[tuple[str, ...]]) -> list[tuple[str, ...]]:
    """Return the processes with the plant's first: devices are there before their drivers look for them."""
    return sorted(processes, key=lambda process: "plant" not in process)


def granted(asked: int) -> int:
    """Return the priority of a run that asks for `asked`: for -1 the usual one where the user may, else 0."""
    if asked >= 0:
        return asked
    return DEFAULT_REALTIME if realtime_permitted() else 0


def prepare(settings: RunSettings) -> int:
    """Set the environment of the run; return the priority it may use.

    Raises:
        NoRealtime: the real robot may use none, and nobody asked to do without.
    """
    environment.apply(settings.domain, settings.other_hosts)
    os.environ[PERIOD_VARIABLE] = repr(1.0 / settings.rate)
    realtime = granted(settings.realtime)
    if not (settings.mock or realtime or settings.realtime == 0):
        raise NoRealtime(DEFAULT_REALTIME)
    return realtime


@contextmanager
def _signals(handler: Callable[[int, FrameType | None], object]) -> Iterator[None]:
    """Let SIGINT and SIGTERM do something else than what they do outside."""
    before = {number: signal.signal(number, handler) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, outside in before.items():
            signal.signal(number, outside)
