"""The statistics of a node on `/diagnostics`, once a second."""

from __future__ import annotations

from rclpy.node import Node

from .ports import advertise, on_tick, ports
from .samples import DiagnosticSample

OK, WARNING = 0, 1


def report_statistics(node: Node) -> None:
    """Publish the statistics of `node` at 1 Hz, as a warning when there were losses since the last report."""
    port = ports(node)
    statistics, before = port.statistics, 0
    publish = advertise(node, "diagnostics")

    def report(stamp: int) -> None:
        nonlocal before
        losses = statistics.losses()
        level, message = (WARNING, f"{losses - before} losses since the last report") if losses > before else (OK, "ok")
        before = losses
        publish(DiagnosticSample(stamp, f"sher3/{port.name}", level, message, tuple(statistics.pairs())))

    per_second = max(1, round(1e9 / port.clock.period_ns))
    # Not all nodes in the same cycle, and never in the cycle of another 1 Hz stream.
    phase = (hash_of(port.name) % 400) / 1000.0 * port.clock.period_ns * 1e-9
    on_tick(node, report, phase=phase + 0.5 * port.clock.period_ns * 1e-9, every=per_second)


def hash_of(name: str) -> int:
    """Return a number of the name that is the same in every process."""
    return sum(ord(letter) * 31**position for position, letter in enumerate(name))
