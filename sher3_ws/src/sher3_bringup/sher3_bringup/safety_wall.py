"""Faults of whole processes in wall time: killed, held for a while, starved by others; measured from recordings.

Each case starts the robot as `sher3 up` does, one process per node, with the strict time limits, lets the surgeon
drive it to speed, and breaks one process. Nobody helps: what `sher3 up` would do when a process ends is left out.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from sher3_bags.reading import read_run
from sher3_runtime.clock import OFFSET_VARIABLE
from sher3_safety.matrix import LIMIT, MOVING, Row, State
from sher3_safety.measure import STANDS, Outcome, Recording
from sher3_safety.processes import HOG, WALL
from sher3_safety.verdict import Verdict, judge

from .fleet import Fleet, Member
from .nodes import make_nodes
from .safety_matrix import MatrixResult
from .settings import RunSettings, checked, parse_processes
from .up import UNHURRIED, prepare

DOMAIN = 230
"""Beyond those of tests and users."""
SPEED_UP, WATCHED, HELD = 1.6, 0.5, 0.3
"""Seconds: from the start to the fault; observed from then on; of a process that is held."""
TRIES = 4
"""A robot that has stopped before the fault, since the machine is busy, is started again so many times."""


def run_wall(
    folder: Path,
    *,
    only: str = "",
    quick: bool = False,
    seed: int = 1,
    jobs: int = 1,
    say: Callable[[str], None] = lambda _: None,
    domain: int = DOMAIN,
) -> MatrixResult:
    """Run the cases in wall time, one after another; bags go to `folder/wall`. See `run_matrix`."""
    del jobs
    verdicts = []
    for row in (row for row in WALL if row.component.startswith(only) and (row.quick or not quick)):
        for state in (LIMIT,) if quick else (MOVING, LIMIT):
            verdict = run_case(row, state, folder / "wall", seed, domain)
            say(f"{row.name}, {state.name}: {'ok' if verdict.holds else '; '.join(verdict.misses)}")
            verdicts.append(verdict)
    options = (f" --only {only}" if only else "") + " --quick" * quick
    return MatrixResult(verdicts, "sher3 safety --wall" + options, seed)


def run_case(row: Row, state: State, folder: Path, seed: int = 1, domain: int = DOMAIN) -> Verdict:
    """Run one case until the robot was at speed when the fault set in; return its verdict."""
    outcome = None
    for attempt in range(TRIES):
        name = f"{row.component}-{row.fault}-{state.name}".replace(" ", "_") + (f"-{attempt}" if attempt else "")
        outcome = _run(row, state, folder / name, seed, domain)
        if outcome is not None and outcome.speed >= 0.8 * state.speed:
            break
    return judge(row, state, outcome, recovered=False)


def _run(row: Row, state: State, bag: Path, seed: int, domain: int) -> Outcome | None:
    import shutil

    shutil.rmtree(bag, ignore_errors=True)
    bag.parent.mkdir(parents=True, exist_ok=True)
    settings = checked(
        record=bag,
        processes=parse_processes(None, mock=True, record=True),
        seed=seed,
        domain=domain,
        # Against other processes real-time priority would win; the point is what happens without it.
        realtime=0 if row.component == HOG else -1,
    )
    realtime = prepare(settings)
    with Fleet() as fleet:
        _launch(fleet, settings, realtime, state, bag)
        fleet.start()
        time.sleep(SPEED_UP)
        onset = _now()
        with _broken(fleet, row):
            time.sleep(WATCHED)
        end = _now()
    robot = settings.robot()
    return Recording(read_run(bag, check=False), robot).outcome(
        row.label(state), onset, end, None, STANDS * state.budget
    )


def _launch(fleet: Fleet, settings: RunSettings, realtime: int, state: State, bag: Path) -> None:
    for process in settings.processes:
        priority = -realtime if set(process) <= UNHURRIED else realtime
        fleet.launch("+".join(process), partial(make_nodes, settings, process), priority)
        if "plant" in process:
            fleet.gather("publishes")
    second = settings.model_copy(update={"record": bag.with_name(bag.name + "-second")})
    fleet.launch("second_recorder", partial(_second_recorder, second), -realtime)
    fleet.launch("surgeon", partial(_surgeon, state.force, state.pedal), realtime)


def _second_recorder(settings: RunSettings) -> list[Any]:
    """Return the recorder that is killed while the first one looks on."""
    import shutil

    assert settings.record is not None
    shutil.rmtree(settings.record, ignore_errors=True)
    return make_nodes(settings, ["recorder"])


def _surgeon(force: float, pedal: float) -> list[Any]:
    from .safety_node import SurgeonNode

    return [SurgeonNode(force, pedal)]


def _now() -> int:
    return time.monotonic_ns() + int(os.environ[OFFSET_VARIABLE])


@contextmanager
def _broken(fleet: Fleet, row: Row) -> Iterator[None]:
    """Break what the row says for as long as the block lasts, or for its own time."""
    name = row.component.partition(".")[2]
    if row.component == HOG:
        with _hogs(int(row.parameters["processes"])):
            yield
        return
    member = _member(fleet, "second_recorder" if name == "recorder" else name)
    if row.fault == "off":
        os.kill(member.pid, signal.SIGKILL)
        yield
        return
    os.kill(member.pid, signal.SIGSTOP)
    try:
        time.sleep(HELD)
        os.kill(member.pid, signal.SIGCONT)
        yield
    finally:
        os.kill(member.pid, signal.SIGCONT)


def _member(fleet: Fleet, name: str) -> Member:
    return next(member for member in fleet.members if member.name == name)


@contextmanager
def _hogs(count: int) -> Iterator[None]:
    """Let `count` processes want the processor."""
    hogs = [multiprocessing.get_context("fork").Process(target=_burn, daemon=True) for _ in range(count)]
    for hog in hogs:
        hog.start()
    try:
        yield
    finally:
        for hog in hogs:
            hog.kill()
            hog.join()


def _burn() -> None:
    while True:
        pass
