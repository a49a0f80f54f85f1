"""The statistics of a node on `/diagnostics`, once a second, computed in small pieces."""

from __future__ import annotations

from collections.abc import Iterator

from rclpy.node import Node
from sher3_common.samples import DiagnosticSample

from sher3_runtime.ports import advertise, on_tick, ports
from sher3_runtime.timing import Statistics

OK, WARNING = 0, 1
STEPS = 20
"""Pieces a second: sorting every histogram in one piece would take longer than a control period."""


def report_statistics(node: Node) -> None:
    """Publish the statistics of `node` at 1 Hz.

    They are a warning when there were losses since the last report.
    """
    port = ports(node)
    publish = advertise(node, "diagnostics")
    report = reports(f"sher3/{port.name}", port.statistics)

    def step(stamp: int) -> None:
        if (sample := next(report)) is not None:
            publish(sample._replace(stamp=stamp))

    period = port.clock.period_ns * 1e-9
    # In the quieter half of the period, and not all nodes at once.
    phase = (0.5 + 0.4 * (sum(map(ord, port.name)) % 16) / 16.0) * period
    on_tick(node, step, phase=phase, every=max(1, round(1.0 / STEPS / period)))


def reports(name: str, statistics: Statistics) -> Iterator[DiagnosticSample | None]:
    """Do one piece of work at each step: yield None, and after `STEPS` pieces or more a finished report.

    A report has the counters of its last step, so that it is not a second old: the supervisor stops the robot for lost
    cycles.
    """
    before = 0
    while True:
        percentiles = []
        for pair in statistics.percentiles():
            percentiles.append(pair)
            yield None
        for _ in range(STEPS - len(percentiles) - 1):
            yield None
        pairs = [*statistics.counters(), *percentiles]
        losses = statistics.losses()
        new, before = losses - before, losses
        message = f"{new} losses since the last report" if new else "ok"
        yield DiagnosticSample(0, name, WARNING if new else OK, message, tuple(pairs))
