"""A process beside the robot, which looks at it at its own pace and wakes nobody: a view, a bridge, a translator."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import rclpy
from rclpy.signals import SignalHandlerOptions

from sher3_runtime import environment
from sher3_runtime.process import stop_on_signals


@contextmanager
def beside(domain: int, period: float, seconds: float | None) -> Iterator[Iterator[float]]:
    """Join a domain, and leave it at the end of the block.

    Yields:
        The moments (`time.monotonic`, s) to look at, `period` s apart, until a signal or for so many seconds; by
        default until a signal.
    """
    environment.apply(domain)
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    try:
        yield _moments(stop_on_signals(), period, seconds)
    finally:
        rclpy.try_shutdown()


def _moments(signalled: Callable[[], bool], period: float, seconds: float | None) -> Iterator[float]:
    begin = time.monotonic()
    while not signalled() and (seconds is None or time.monotonic() - begin < seconds):
        now = time.monotonic()
        yield now
        time.sleep(max(0.0, period - (time.monotonic() - now)))
