"""Is the control loop on time, and is the supervisor alive? Pure, with time as an argument (ns)."""

from __future__ import annotations

from sher3_common.reasons import Reason

from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.watches.trips import Trip


class LoopWatch:
    """The driver's own timing: the grid of stamps against the clock, and the age of the supervisor's heartbeat.

    Attributes:
        stall: longest time between two ticks so far, ns.
        heard_at: newest heartbeat of the supervisor, ns; None before the first.
    """

    def __init__(self, settings: MotorDriverSettings) -> None:
        self._stall_limit = round(settings.stall_limit * 1e9)
        self._supervisor_limit = round(settings.supervisor_limit * 1e9)
        self._stamp = self._now = 0
        self.stall = 0
        self.heard_at: int | None = None

    def tick(self, stamp: int, now: int) -> Trip | None:
        """Judge the step from the last tick to this one, which bears `stamp` and begins at `now`."""
        before, self._stamp = self._stamp, stamp
        started, self._now = self._now, now
        if not started:
            return None
        gap, step = now - started, stamp - before
        self.stall = max(self.stall, gap)
        if step <= 0 or abs(step - gap) > self._stall_limit:
            text = f"the tick's stamp moved {step * 1e-6:.3f} ms while the clock moved {gap * 1e-6:.3f} ms"
            return Trip(Reason.CLOCK, text, abs(step - gap) * 1e-9, self._stall_limit * 1e-9, "s")
        if gap > self._stall_limit:
            text = f"the control loop was held up for {gap * 1e-6:.1f} ms (limit {self._stall_limit * 1e-6:g} ms)"
            return Trip(Reason.CPU_STARVED, text, gap * 1e-9, self._stall_limit * 1e-9, "s")
        return None

    def hear_supervisor(self, now: int) -> None:
        """Take note of the supervisor's heartbeat."""
        self.heard_at = now

    def supervisor(self, now: int) -> Trip | None:
        """Judge the age of the supervisor's heartbeat; a supervisor that was never heard is too old."""
        if self.heard_at is not None and now - self.heard_at <= self._supervisor_limit:
            return None
        age = float("inf") if self.heard_at is None else (now - self.heard_at) * 1e-9
        text = f"the supervisor has been silent for {age * 1e3:.1f} ms (limit {self._supervisor_limit * 1e-6:g} ms)"
        return Trip(Reason.SUPERVISOR_SILENT, text, age, self._supervisor_limit * 1e-9, "s")
