"""The gap monitor on the graph: gap over floor per stage on `gap/diagnostics` at 1 Hz; all else is in `monitor`."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from typing import Any

import rclpy
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from sher3_common.samples import DiagnosticSample
from sher3_description import Robot
from sher3_runtime import environment
from sher3_runtime.execution.spinning import spin
from sher3_runtime.ports import NODE_OPTIONS, PERIOD_VARIABLE, advertise, on_tick, subscribe
from sher3_runtime.process import stop_on_signals
from sher3_sim import PlantEffect

from sher3_gap.live.monitor import TOPICS, Monitor, StageStatus
from sher3_gap.live.naming import Named, Naming

TOPIC = "gap/diagnostics"
MESSAGES = ("at the floor", "gap above the floor", "gap far above the floor")
WARNED, STALE = 1, 3
Say = Callable[[int, list[StageStatus], Named | None], None]


class GapMonitorNode(Node):
    """Listens to the robot's streams and publishes one status per stage and axis at 1 Hz.

    A gap that stays is named on the same topic.
    `told` gets the stamp and what is published, once a second; no statuses while there is no whole window to judge.
    """

    def __init__(
        self,
        robot: Robot,
        effects: Sequence[PlantEffect] = (),
        *,
        window: float = 4.0,
        say: Say | None = None,
        **options: Any,
    ) -> None:
        super().__init__("gap_monitor", **{**NODE_OPTIONS, **options})
        self.monitor = Monitor(robot, effects, window)
        self._publish, self._say = advertise(self, TOPIC), say
        self.naming = Naming(robot, self.monitor.stretch, executor=ThreadPoolExecutor(1, "naming"))
        for topic in TOPICS:
            subscribe(self, topic, self._feeder(topic), depth=500)
        on_tick(self, self._tick, every=round(1.0 / robot.control_period))

    def _feeder(self, topic: str) -> Callable[[Any], None]:
        feed = self.monitor.feed
        return lambda sample: feed(topic, sample)

    def _tick(self, stamp: int) -> None:
        found = self.monitor.judge()
        for status in found:
            self._publish(diagnostic(stamp, status))
        named = self.naming.look(stamp, any(s.level for s in found)) if found else self.naming.named
        if named is not None:
            self._publish(cause_diagnostic(stamp, named))
        if self._say is not None:
            self._say(stamp, found, named)
        if not found:
            self._publish(DiagnosticSample(stamp, "gap", STALE, "waiting for a window without long holes"))


def diagnostic(stamp: int, status: StageStatus) -> DiagnosticSample:
    """Return a stage's status as a diagnostic: gap, floor and their ratio."""
    values = (
        ("gap", f"{status.gap:.6g}"),
        ("floor", f"{status.floor:.6g}"),
        ("ratio", f"{status.ratio:.4g}"),
        ("unit", status.unit),
    )
    name = f"gap/{status.stage}/{status.actuator}"
    return DiagnosticSample(stamp, name, status.level, MESSAGES[status.level], values)


def cause_diagnostic(stamp: int, named: Named) -> DiagnosticSample:
    """Return the verdict as a diagnostic: status, causes, and their probability where the verdict states it."""
    causes = [f"{c.effect} on {c.actuator}" for c in named.verdict.causes]
    known = () if named.probability is None else (("probability", f"{named.probability:.3g}"),)
    values = (("status", named.verdict.status), ("causes", "; ".join(causes)), *known)
    return DiagnosticSample(stamp, "gap/cause", WARNED, named.text, values)


def judged_json(stamp: int, found: Sequence[StageStatus], named: Named | None = None) -> str:
    """Return what was judged at `stamp` [ns] as one line of JSON; no stages while there is no whole window."""
    stages = [{**asdict(s), "ratio": s.ratio, "level": s.level} for s in found]
    cause = None
    if named is not None:
        causes = [{"effect": c.effect, "actuator": c.actuator} for c in named.verdict.causes]
        cause = {"status": named.verdict.status, "causes": causes, "probability": named.probability, "text": named.text}
    return json.dumps({"stamp": stamp, "stages": stages, "cause": cause})


def run(robot: Robot, effects: Sequence[PlantEffect], window: float, domain: int = 0, say: Say | None = None) -> None:
    """Run the monitor in a process of its own beside a running graph until a signal; `say` as in the node."""
    environment.apply(domain)
    os.environ[PERIOD_VARIABLE] = repr(robot.control_period)
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    try:
        stop = stop_on_signals()
        spin([GapMonitorNode(robot, effects, window=window, say=say)], stop=stop, diagnostics=False)
    finally:
        rclpy.try_shutdown()
