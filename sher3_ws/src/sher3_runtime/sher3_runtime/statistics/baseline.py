"""The same nodes on rclpy's own executor with message objects and timers: the baseline of the bench."""

from __future__ import annotations

import select
import threading
from collections.abc import Callable
from typing import Any

from rclpy.clock import Clock as RosClock
from rclpy.clock import ClockType
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from sher3_runtime.ports import clock_of, ports
from sher3_runtime.tick import Tick


class BaselineExecutor(SingleThreadedExecutor):
    """rclpy's executor, with each tick as a timer that is started on the grid and each file watched by a thread."""

    def watch_files(self) -> None:
        """Start the file watchers of the nodes added so far."""
        for node in self.get_nodes():
            for file, callback in ports(node).readables:
                _start_watcher(node, file, callback)

    def start_ticks(self) -> None:
        """Start the timers of the nodes added so far, each on the grid."""
        for node in self.get_nodes():
            for tick in ports(node).ticks:
                _start_timer(node, tick)


def _start_timer(node: Node, tick: Tick) -> None:
    """Wait for the grid with one timer, then continue with a periodic timer that stays on the grid."""
    clock = clock_of(node)
    # The middleware's steady clock is the raw one, which drifts off the grid by milliseconds within seconds.
    system = RosClock(clock_type=ClockType.SYSTEM_TIME)
    tick.schedule()

    def on_timer() -> None:
        # A tick that is `done` is due a period later.
        if (now := clock.now()) > tick.due_ns - tick.period_ns // 2:
            tick.run(now)

    def on_grid() -> None:
        node.create_timer(tick.period_ns * 1e-9, on_timer, clock=system)
        node.destroy_timer(first)
        on_timer()

    first = node.create_timer(max(0, tick.due_ns - clock.now()) * 1e-9, on_grid, clock=system)


def _start_watcher(node: Node, file: Any, callback: Callable[[], None]) -> None:
    handled = threading.Event()

    def on_data() -> None:
        callback()
        handled.set()

    guard = node.create_guard_condition(on_data)

    def watch() -> None:
        while node.context.ok():
            readable, _, _ = select.select([file], (), (), 0.1)
            if readable and node.context.ok():
                handled.clear()
                guard.trigger()
                handled.wait(0.1)

    threading.Thread(target=watch, daemon=True).start()
