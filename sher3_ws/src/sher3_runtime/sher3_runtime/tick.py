"""Periodic callbacks on the clock grid, and a round of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from sher3_runtime.clock import Clock
from sher3_runtime.composed.turn import Turn
from sher3_runtime.timing import Histogram, Statistics


class Tick:
    """A callback on the grid: when it is due next, and counts of how punctual it was.

    Attributes:
        phase_ns: Delay behind the stamp [ns].
        due_ns: Time of the next call [ns]; `due_ns - phase_ns` is its stamp.
        turn: Of the node, where it shares a process: while another callback of the node is at work, the call waits.

    Its stamps are the multiples of `every` periods, `offset` periods later.
    """

    def __init__(
        self,
        callback: Callable[[int], None],
        phase_ns: int,
        every: int,
        clock: Clock,
        statistics: Statistics,
        turn: Turn | None = None,
        offset: int = 0,
    ) -> None:
        self.callback = callback
        self.phase_ns = phase_ns
        self.period_ns = every * clock.period_ns
        self.due_ns = 0
        self.turn = turn
        self._offset_ns = offset * clock.period_ns
        self._clock = clock
        self._statistics = statistics
        self._duration = statistics.callback.setdefault("tick", Histogram())
        self._last_start = 0
        # Slow ticks (states at 1 Hz) would hide the jitter of the control loop.
        self._counts = every == 1

    def schedule(self) -> None:
        """Set `due_ns` to the first stamp of this tick from now on."""
        after = self._clock.now() - self.phase_ns
        earliest = max(after + 1, self._clock.start_ns) - self._offset_ns
        self.due_ns = -(-earliest // self.period_ns) * self.period_ns + self._offset_ns + self.phase_ns

    def done(self, stamp: int) -> None:
        """Skip the call for `stamp`, whose work has been done already; this saves one wake-up a period."""
        if self.due_ns - self.phase_ns == stamp:
            self.due_ns += self.period_ns
            if self._counts:
                self._statistics.ticks += 1
                self._count_period(self._clock.now())

    def run(self, now: int, begin: int | None = None) -> None:
        """Call the callback for the latest stamp that was due when its round began, which was now by default [ns]."""
        begin = now if begin is None else begin
        if self.turn is None:
            self._run(now, begin)
        elif not self.turn.taken:
            with self.turn:
                self._run(now, begin)

    def _run(self, now: int, begin: int) -> None:
        late = now - self.due_ns
        missed = max(begin - self.due_ns, 0) // self.period_ns
        stamp = self.due_ns - self.phase_ns + missed * self.period_ns
        self.due_ns += (missed + 1) * self.period_ns
        if not self._counts:
            self.callback(stamp)
            return
        statistics = self._statistics
        statistics.ticks += 1
        statistics.lost_cycles += missed
        statistics.wakeup.add(late)
        self._count_period(now)
        self.callback(stamp)
        duration = self._clock.now() - now
        self._duration.add(duration)
        if duration > self.period_ns:
            statistics.overruns += 1

    def _count_period(self, now: int) -> None:
        if self._last_start:
            self._statistics.period.add(now - self._last_start)
        self._last_start = now


def run_due(ticks: Iterable[Tick], clock: Clock) -> None:
    """Run the ticks that are due, in the order given, which is that of their phases: one round.

    A round belongs to one period. Where the drives' answer to a SYNC is late, the force sensor's tick behind it still
    is that of the SYNC: its record is there, and the one of the next period will be asked for by the next SYNC.
    """
    begin = now = clock.now()
    for tick in ticks:
        if now >= tick.due_ns:
            tick.run(now, begin)
            now = clock.now()
