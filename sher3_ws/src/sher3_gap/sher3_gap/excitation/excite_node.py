"""Excitations on the running graph: the player's body, and the recording of what came of it as a case."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import rclpy
from rclpy.logging import LoggingSeverity
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from sher3_bags import Run, Stream, read_run, write_case
from sher3_bags.errors import CaseError
from sher3_bags.recording.recorder_node import RecorderNode
from sher3_bags.run import CONTRACT_TOPICS
from sher3_common import FileError, parse_json
from sher3_common.progress import Say, silent
from sher3_common.samples import JointSample, TextSample, WrenchSample
from sher3_description import Robot
from sher3_runtime import environment
from sher3_runtime.execution.spinning import spin
from sher3_runtime.ports import NODE_OPTIONS, PERIOD_VARIABLE, advertise, on_tick, subscribe
from sher3_runtime.process import stop_on_signals

from sher3_gap.case.ticks import LONGEST_HOLE, LOST_SHARE
from sher3_gap.excitation import Excitation
from sher3_gap.excitation.player import Phase, Player, PlayError

RECORDED = tuple(topic for topic in CONTRACT_TOPICS if topic != "servo_cv")
"""Topics of a recorded run; an excitation commands axes, so no speed of the tip is commanded."""
LINGER = 100_000_000
"""Nanoseconds the recorder listens on after the last tick."""
TRIES = 5
"""Times a run is played until few ticks are lost."""
FEW_LOST = 0.005
"""Share of lost ticks with which a run is kept at once."""


class ExciteNode(Node):
    """Plays one excitation.

    Attributes:
        player: the plain player behind it.
        failure: what ended it early, or None.
    """

    def __init__(self, player: Player, **options: Any) -> None:
        super().__init__("excite", **{**NODE_OPTIONS, **options})
        self.player = player
        self.failure: PlayError | None = None
        self.finished = False
        self._state = advertise(self, "command/state_command")
        self._move = advertise(self, "command/move_jp")
        self._servo = advertise(self, "command/servo_jp")
        self._wrench = advertise(self, "mock/contact_wrench") if player.excitation.loads else None
        heard = player.heard
        subscribe(self, "operating_state", lambda s: setattr(heard, "state", s.text))
        subscribe(self, "motion/status", lambda s: setattr(heard, "mode", _mode_of(s.text)))
        subscribe(self, "measured_js", lambda s: setattr(heard, "position", s.position or ()))
        on_tick(self, self._tick)

    def _tick(self, stamp: int) -> None:
        if self.finished:
            return
        player = self.player
        try:
            command, move, points, load = player.tick(stamp)
        except PlayError as error:
            self.failure, self.finished = error, True
            return
        if command is not None:
            self._state(TextSample(command))
        if move:
            self._move(JointSample(stamp, player.start))
        for point in points:
            self._servo(JointSample(point.stamp, point.position, point.velocity))
        if self._wrench is not None:
            self._wrench(WrenchSample(stamp, load))
        self.finished = player.phase is Phase.DONE and stamp > player.last + LINGER


def excite_graph(
    robot: Robot,
    excitations: Iterable[tuple[Excitation, int]],
    output: Path,
    say: Say = silent,
    domain: int = 0,
) -> Path:
    """Play and record each (excitation, repeat) on the running graph and write the runs as a new case.

    When the robot stops on the way, the runs that are complete are written before the error is raised.

    Raises:
        PlayError: the robot did not follow; BagError: the case exists already.
    """
    environment.apply(domain)
    os.environ[PERIOD_VARIABLE] = repr(robot.control_period)
    if output.exists():
        raise CaseError("exists already", path=output, remedy="choose another name")
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    runs: list[Run] = []
    try:
        with tempfile.TemporaryDirectory() as scratch:
            player = _Turns(robot, Path(scratch), stop_on_signals(), say)
            try:
                for excitation, repeat in excitations:
                    say(f"{excitation.label}, repeat {repeat}")
                    runs.append(player.play(excitation, repeat))
            except PlayError as error:
                if runs:
                    write_case(output, runs, robot)
                    error.remedy = (
                        f"{error.remedy or 'see supervisor/status'}; {len(runs)} complete runs are in {output}"
                    )
                raise
            return write_case(output, runs, robot)
    finally:
        rclpy.try_shutdown()


def _mode_of(text: str) -> str | None:
    """Return the owner in a `motion/status`; a damaged one names an unknown owner, which is never waited out."""
    try:
        return parse_json(text)["mode"]
    except (FileError, KeyError, TypeError):
        return "unknown"


@dataclass
class _Turns:
    """Plays and records run after run; one that the machine was too busy to record is played again."""

    robot: Robot
    scratch: Path
    stopped: Callable[[], bool]
    say: Say
    count: int = 0

    def play(self, excitation: Excitation, repeat: int) -> Run:
        """Return the first of `TRIES` recordings that lost few ticks, else the best; PlayError where all lost many."""
        best: tuple[float, Run] | None = None
        for _ in range(TRIES):
            run = self._once(excitation, repeat)
            lost = lost_share(run, excitation)
            if best is None or lost < best[0]:
                best = lost, run
            if lost <= FEW_LOST:
                return run
            self.say(f"{lost:.1%} of the ticks were lost, once more")
        assert best is not None
        if best[0] > LOST_SHARE:
            raise PlayError(
                "the machine is too busy to record",
                value=f"{best[0]:.1%} of the ticks lost",
                limit=f"{LOST_SHARE:.0%}",
                remedy="end other work, or start the robot with fewer processes (`sher3 up --nodes`)",
            )
        return best[1]

    def _once(self, excitation: Excitation, repeat: int) -> Run:
        bag = self.scratch / f"bag_{self.count:03d}"
        self.count += 1
        player = Player(excitation, self.robot)
        metadata = excitation.metadata(repeat, origin="robot")
        node, recorder = ExciteNode(player), RecorderNode(bag, self.robot, topics=RECORDED, metadata=metadata)
        recorder.get_logger().set_level(LoggingSeverity.ERROR)
        spin([node, recorder], stop=lambda: self.stopped() or node.finished, diagnostics=False)
        if node.failure is not None:
            raise node.failure
        if player.phase is not Phase.DONE:
            raise PlayError("stopped before the end", value=player.phase.value, remedy="let it play to its end")
        return trimmed(read_run(bag, check=False), player.first, player.last)


def lost_share(run: Run, excitation: Excitation) -> float:
    """Return the share of an excitation's ticks that a recording lacks; 1 where its longest hole cannot be bridged."""
    if "drives/measured_js" not in run or len(run["drives/measured_js"]) < 2:
        return 1.0
    stamps = run["drives/measured_js"].stamp
    if np.diff(stamps).max() > 1e9 * LONGEST_HOLE:
        return 1.0
    return 1.0 - len(stamps) / len(excitation.position)


def trimmed(run: Run, first: int, last: int) -> Run:
    """Return the samples of a run whose stamps lie between two stamps [ns]; texts are kept whole."""
    return replace(run, streams={topic: _cut(s, first, last) for topic, s in run.streams.items()})


def _cut(stream: Stream, first: int, last: int) -> Stream:
    if "data" in stream.columns:
        return stream
    keep = (stream.stamp >= first) & (stream.stamp <= last)
    columns = {name: np.asarray(values)[keep] for name, values in stream.columns.items()}
    logged = None if stream.log_time is None else stream.log_time[keep]
    return Stream(stream.type, stream.stamp[keep], stream.frame_id, columns, logged)
