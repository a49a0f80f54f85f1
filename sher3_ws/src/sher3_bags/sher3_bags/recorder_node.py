"""Record the graph: raw bytes of every topic of the table into a new bag."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import rclpy
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from sher3_description import TOPICS, Robot, load_robot
from sher3_runtime import environment
from sher3_runtime.ports import NODE_OPTIONS, clock_of, subscribe_raw
from sher3_runtime.process import stop_on_signals
from sher3_runtime.spinning import spin

from sher3_bags.recorder import Recorder
from sher3_bags.run import RunMetadata

DEPTH = 2000
"""Samples that may wait while a chunk is compressed or the disk is slow: four seconds of a 500 Hz stream."""


class RecorderNode(Node):
    """Records `topics` (by default all) into the new folder `output`; `close` completes the bag and reports losses.

    Attributes:
        recorder: the plain recorder behind it.
        counts: per topic, set by `close`.
    """

    def __init__(
        self,
        output: Path | str,
        robot: Robot | None = None,
        *,
        topics: Iterable[str] | None = None,
        metadata: RunMetadata | None = None,
        parameters: dict[str, Any] | None = None,
        **options: Any,
    ) -> None:
        super().__init__("recorder", **{**NODE_OPTIONS, **options})
        self.recorder = Recorder(Path(output), robot or load_robot(), metadata, parameters)
        self.counts: dict[str, dict[str, int]] = {}
        for name in TOPICS if topics is None else topics:
            subscribe_raw(self, name, self._receiver(name), depth=DEPTH)

    def _receiver(self, name: str) -> Callable[[bytes], None]:
        write, now = self.recorder.write, clock_of(self).now
        return lambda data: write(name, data, now())

    def close(self) -> None:
        """Complete the bag; say what is in it and what was missed."""
        if self.recorder.closed:
            return
        self.counts = self.recorder.close()
        total = sum(entry["messages"] for entry in self.counts.values())
        self.get_logger().info(f"recorded {total} messages of {len(self.counts)} topics in {self.recorder.folder}")
        for topic, entry in self.counts.items():
            if entry["dropped"] or entry["disordered"]:
                self.get_logger().warning(
                    f"{topic}: {entry['dropped']} samples dropped, {entry['disordered']} out of order"
                )


def run(
    output: Path, robot: Robot | None = None, *, topics: Iterable[str] | None = None, seconds: float | None = None
) -> dict[str, dict[str, int]]:
    """Record in a process of its own until a signal or for `seconds`; return the counts per topic.

    Raises:
        BagError: the output exists.
    """
    environment.apply()
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    try:
        stop = stop_on_signals()
        node = RecorderNode(output, robot, topics=topics)
        end = time.monotonic() + (float("inf") if seconds is None else seconds)
        spin([node], stop=lambda: stop() or time.monotonic() > end, diagnostics=False)
        return node.counts
    finally:
        rclpy.try_shutdown()
