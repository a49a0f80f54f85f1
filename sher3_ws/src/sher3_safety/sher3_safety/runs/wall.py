"""Faults of whole processes in wall time: killed, held for a while, starved by others; measured from recordings.

Each case starts the robot as `sher3 up` does, one process per node, with the strict time limits, lets the surgeon
drive it to speed, and breaks one process. Nobody helps: what `sher3 up` would do when a process ends is left out, and
hand and foot stay where they are until all is measured.
"""

from __future__ import annotations

import multiprocessing
import os
import re
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sher3_bags.reading import read_run
from sher3_bringup.errors import ConfigurationError, NotStopped, StartError
from sher3_bringup.processes.fleet import Fleet, Member
from sher3_bringup.processes.nodes import make_nodes
from sher3_bringup.processes.up import beside, launch_nodes, prepare
from sher3_bringup.settings.run_settings import RunSettings, checked, parse_processes
from sher3_common import make_folder
from sher3_runtime.clock import OFFSET_VARIABLE
from sher3_runtime.domains import PROCESSES, claim_domain, release_domain

from sher3_safety.measurement.recording import STANDS, Outcome, Recording
from sher3_safety.measurement.verdict import UNMEASURED, Verdict, judge
from sher3_safety.rows.processes import HOG, WALL, WALL_STATES
from sher3_safety.rows.row import LIMIT, Row, State, select
from sher3_safety.runs.matrix import MatrixResult

SPEED_UP, WATCHED, HELD, STILL = 2.6, 0.5, 0.3, 0.3
"""Seconds: from the start to the fault; of its observation; for which a process is held; and of the rest afterwards, in
which hand and foot stay and a robot that has stopped must not move. With busy processes the rest is observed too."""
TRIES = 8
"""Most starts of a case: on a busy machine the robot may have stopped before the fault, four times in one cell of a run
of the tests."""
PATIENCE, RUN_LIMIT = 20.0, 900.0
"""Seconds: longest start of a robot; and of all cases together, after which further ones are not begun."""
HAND_GAP = 100_000_000
"""Longest silence of the surgeon, ns. After 0.2 s the plant lets hand and foot go, and the tip gives way a little, see
`docs/reference/wall-faults.md`: that is no motion of the robot's own."""


def run_wall(
    folder: Path,
    *,
    only: str = "",
    quick: bool = False,
    seed: int = 1,
    jobs: int = 1,
    say: Callable[[str], None] = lambda _: None,
    domain: int | None = None,
    limit: float = RUN_LIMIT,
) -> MatrixResult:
    """Run the cases in wall time, one after another; bags go to `folder/wall`. See `run_matrix`.

    `domain`: ROS domain of all cases; by default each start claims one of its own.

    Raises:
        ConfigurationError: no component's name begins so.
    """
    del jobs
    verdicts, end = [], time.monotonic() + limit
    rows = list(select(WALL, only, quick))
    if not rows:
        known = ", ".join(dict.fromkeys(row.component for row in WALL))
        raise ConfigurationError("no such component in wall time", value=only, limit=known, remedy="choose one")
    for row, state in product(rows, (LIMIT,) if quick else WALL_STATES):
        if time.monotonic() < end:
            verdict = run_case(row, state, folder / "wall", seed, domain)
        else:
            verdict = Verdict(row, state, None, (f"not begun: the run takes longer than {limit:g} s",))
        say(f"{row.name}, {state.name}: {'ok' if verdict.holds else '; '.join(verdict.misses)}")
        verdicts.append(verdict)
    options = (f" --only {only}" if only else "") + " --quick" * quick
    return MatrixResult(verdicts, "sher3 safety --wall" + options, seed)


def run_case(row: Row, state: State, folder: Path, seed: int = 1, domain: int | None = None) -> Verdict:
    """Run one case until the robot was enabled and at speed when the fault set in; return its verdict."""
    outcome = None
    for attempt in range(TRIES):
        name = re.sub(r"[^\w.]+", "_", f"{row.name} {state.name}") + (f"-{attempt}" if attempt else "")
        try:
            with _domain(domain) as own:
                outcome = _run(row, state, folder / name, seed, own)
        except StartError as error:
            return Verdict(row, state, None, (f"did not start: {error}",))
        ready = outcome is not None and outcome.operating in ("", state.operating)
        if outcome is not None and ready and outcome.speed >= 0.8 * state.speed:
            break
    else:
        return _unmeasured(row, state, outcome)
    return judge(row, state, outcome, recovered=False)


@contextmanager
def _domain(given: int | None) -> Iterator[int]:
    """Claim a ROS domain for one start, if none is given.

    Another run on this computer, or what is left of a robot that was killed in the start before, would be heard in a
    domain that all share.
    """
    domain = claim_domain(PROCESSES) if given is None else given
    try:
        yield domain
    finally:
        release_domain(domain)


def _unmeasured(row: Row, state: State, outcome: Outcome | None) -> Verdict:
    why = "the robot had stopped before" if outcome is not None else "the surgeon was held up"
    return Verdict(row, state, outcome, (f"{UNMEASURED}: {why}, {TRIES} times; the machine is too busy",))


def _run(row: Row, state: State, bag: Path, seed: int, domain: int) -> Outcome | None:
    """Run one case and return its outcome, None when the surgeon did not hold on all the time."""
    import shutil

    shutil.rmtree(bag, ignore_errors=True)
    make_folder(bag.parent)
    settings = checked(
        record=bag,
        processes=parse_processes(None, mock=True, record=True),
        seed=seed,
        domain=domain,
        realtime=int(row.parameters.get("realtime", -1)),
        regime="free",
    )
    onset, end, still = _play(settings, prepare(settings), row, state)
    run = read_run(bag, check=False)
    if _longest_silence(run["mock/contact_wrench"].stamp, onset, still) > HAND_GAP:
        return None
    return Recording(run, settings.robot()).outcome(row.label(state), onset, end, still, STANDS * state.budget)


def _play(settings: RunSettings, realtime: int, row: Row, state: State) -> tuple[int, int, int]:
    """Let the case happen; return its onset, the end of its observation and of the rest after it, ns."""
    try:
        with Fleet() as fleet:
            _launch(fleet, settings, realtime, state, row)
            fleet.start(PATIENCE)
            time.sleep(SPEED_UP)
            onset = _now()
            with _broken(fleet, row):
                time.sleep(WATCHED)
                end = _now()
                time.sleep(STILL)
                still = _now()
                end = still if row.component == HOG else end  # busy processes may stop the robot at any time
    except NotStopped as error:  # all is measured by then, and nothing is left running
        print(f"sher3: {row.name}, {state.name}: {error}", file=sys.stderr)
    return onset, end, still


def _longest_silence(stamps: NDArray[np.int64], begin: int, end: int) -> int:
    """Return the longest time without a sample between two times, ns."""
    inside = stamps[(stamps > begin) & (stamps < end)]
    return int(np.diff(np.concatenate([[begin], np.sort(inside), [end]])).max())


def _launch(fleet: Fleet, settings: RunSettings, realtime: int, state: State, row: Row) -> None:
    launch_nodes(fleet, settings, realtime, PATIENCE)
    if row.component == "process.recorder":
        assert settings.record is not None
        second = settings.model_copy(update={"record": settings.record.with_name(settings.record.name + "-second")})
        fleet.launch("second_recorder", partial(_second_recorder, second), -realtime)
    fleet.launch("surgeon", partial(_surgeon, state.force, state.pedal), beside(realtime))


def _second_recorder(settings: RunSettings) -> list[Any]:
    """Return the recorder that is killed while the first one looks on."""
    import shutil

    assert settings.record is not None
    shutil.rmtree(settings.record, ignore_errors=True)
    return make_nodes(settings, ["recorder"])


def _surgeon(force: float, pedal: float) -> list[Any]:
    from sher3_safety.runs.operator_node import SurgeonNode

    return [SurgeonNode(force, pedal)]


def _now() -> int:
    return time.monotonic_ns() + int(os.environ[OFFSET_VARIABLE])


@contextmanager
def _broken(fleet: Fleet, row: Row) -> Iterator[None]:
    """Break the part that the row names: a hold for `HELD` seconds, anything else for as long as the block lasts."""
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
    finally:
        os.kill(member.pid, signal.SIGCONT)
    yield


def _member(fleet: Fleet, name: str) -> Member:
    return next(member for member in fleet.members if member.name == name)


@contextmanager
def _hogs(count: int) -> Iterator[None]:
    """Keep `count` processes busy for as long as the block lasts."""
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
