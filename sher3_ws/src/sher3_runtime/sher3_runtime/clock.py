"""The clock grid: every process computes the same ticks `t_k = k T` of the system time without a master.

Stamps are integer nanoseconds of the system time. The wall clock reads the monotonic clock and adds an offset that is
frozen at start, so a correction of the system time during a run moves nothing; `sher3 up` gives the same offset to
every process. The stepped clock is at rest between two steps.
"""

from __future__ import annotations

import ctypes
import os
import time
from contextlib import suppress
from time import monotonic_ns

OFFSET_VARIABLE = "SHER3_CLOCK_OFFSET"
NEVER_NS = 1 << 62
"""A time [ns] that does not come."""
_PR_SET_TIMERSLACK = 29


class Clock:
    """The system time on a frozen offset, and its grid of period `period_ns`.

    Attributes:
        period_ns: the control period T.
        start_ns: first stamp that ticks are given; ticks before it are skipped (the start barrier sets it).
    """

    stepped = False

    def __init__(self, period_ns: int, offset_ns: int | None = None) -> None:
        if offset_ns is None:
            offset_ns = int(os.environ.get(OFFSET_VARIABLE) or system_offset())
        self.period_ns = period_ns
        self.offset_ns = offset_ns
        self.start_ns = 0

    def now(self) -> int:
        """Return the time in ns of the system clock's epoch."""
        return monotonic_ns() + self.offset_ns


class SteppedClock(Clock):
    """A clock that only moves when it is told to; for tests and for replay faster or slower than real time."""

    stepped = True

    def __init__(self, period_ns: int, start_ns: int = 1_000_000_000_000_000_000) -> None:
        super().__init__(period_ns, offset_ns=0)
        self.start_ns = -(-start_ns // period_ns) * period_ns
        self.time_ns = self.start_ns

    def now(self) -> int:
        """Return the time that was set last."""
        return self.time_ns


def system_offset() -> int:
    """Return system time minus monotonic time in ns, from the tightest of a few readings."""
    best = min(
        ((after - before, system - (before + after) // 2) for before, system, after in (_reading() for _ in range(9))),
    )
    return best[1]


def _reading() -> tuple[int, int, int]:
    return time.monotonic_ns(), time.time_ns(), time.monotonic_ns()


def set_timer_slack(ns: int = 1) -> None:
    """Let the kernel wake this thread at the time it asked for; the default slack is 50 us (Linux only)."""
    with suppress(OSError, AttributeError):
        ctypes.CDLL(None, use_errno=True).prctl(_PR_SET_TIMERSLACK, ctypes.c_ulong(ns), 0, 0, 0)
