"""Excitations on the running graph: the player's body, and the recording of what came of it as a case."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import rclpy
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from sher3_bags import CaseError, Run, Stream, read_run, write_case
from sher3_bags.recorder_node import RecorderNode
from sher3_description import Robot
from sher3_runtime import JointSample, TextSample, WrenchSample, environment
from sher3_runtime.ports import NODE_OPTIONS, PERIOD_VARIABLE, advertise, on_tick, subscribe
from sher3_runtime.process import stop_on_signals
from sher3_runtime.spinning import spin

from sher3_gap.excitation import Excitation
from sher3_gap.player import Phase, Player, PlayError

RECORDED = (
    "setpoint_js",
    "servo_jv",
    "drives/setpoint_jv",
    "drives/measured_js",
    "measured_js",
    "measured_cp",
    "force/measured_cf",
    "pedal/measured",
    "tracker/measured_cp",
    "temperature",
    "operating_state",
)
"""Topics of a recorded run (contract, section 4)."""
LINGER = 100_000_000
"""Nanoseconds the recorder listens on after the last tick."""


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
        subscribe(self, "motion/status", lambda s: setattr(heard, "mode", json.loads(s.text)["mode"]))
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
    say: Callable[[str], None] = lambda _: None,
    domain: int = 0,
) -> Path:
    """Play and record each (excitation, repeat) on the running graph and write the runs as a new case.

    Raises:
        PlayError: the robot did not follow; BagError: the case exists already.
    """
    environment.apply(domain)
    os.environ[PERIOD_VARIABLE] = repr(robot.control_period)
    if output.exists():
        raise CaseError("exists already", path=output, remedy="choose another name")
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    try:
        with tempfile.TemporaryDirectory() as scratch:
            signalled, runs = stop_on_signals(), []
            for index, (excitation, repeat) in enumerate(excitations):
                say(f"{excitation.label}, repeat {repeat}")
                runs.append(_play(robot, excitation, repeat, Path(scratch, f"bag_{index:02d}"), signalled))
            return write_case(output, runs, robot)
    finally:
        rclpy.try_shutdown()


def _play(robot: Robot, excitation: Excitation, repeat: int, bag: Path, signalled: Callable[[], bool]) -> Run:
    player = Player(excitation, robot)
    metadata = excitation.metadata(repeat, origin="robot")
    node, recorder = ExciteNode(player), RecorderNode(bag, robot, topics=RECORDED, metadata=metadata)
    spin([node, recorder], stop=lambda: signalled() or node.finished, diagnostics=False)
    if node.failure is not None:
        raise node.failure
    if player.phase is not Phase.DONE:
        raise PlayError("stopped before the end", value=player.phase.value)
    return trimmed(read_run(bag, check=False), player.first, player.last)


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
