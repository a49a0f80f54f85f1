"""What a process knows about its own timing: histograms in nanoseconds, counters, and a trace for the bench."""

from __future__ import annotations

import json
import struct
from collections import deque
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

_SUB_BITS = 4
_BUCKETS = 61 << _SUB_BITS + 1
"""Enough for the longest duration of 63 bits."""
PENDING = 1 << 15
"""Durations that wait to be sorted: those of half a minute at 1 kHz, and reports look every second."""
_PAIR = struct.Struct("=qq")


class Histogram:
    """Counts of durations in buckets of 1/16 octave: a percentile is at most 6 % too high, the maximum is exact.

    Adding a duration appends to a queue, which is all that a control loop can afford. The buckets are filled when
    somebody looks; of more than `PENDING` durations between two looks the newest count.

    Attributes:
        add: Counts one duration [ns]; a negative one counts as zero.
    """

    __slots__ = ("_buckets", "_count", "_maximum", "_pending", "_total", "add")

    def __init__(self) -> None:
        self._pending: deque[int] = deque(maxlen=PENDING)
        self.add: Callable[[int], None] = self._pending.append
        self._buckets = np.zeros(_BUCKETS, dtype=np.int64)
        self._count = self._total = self._maximum = 0

    def _sort(self) -> None:
        if not self._pending:
            return
        values = np.maximum(np.array(self._pending, dtype=np.int64), 0)
        self._pending.clear()
        shift = np.maximum(np.frexp(values.astype(float))[1] - _SUB_BITS - 1, 0)
        self._buckets += np.bincount((shift << (_SUB_BITS + 1)) + (values >> shift), minlength=_BUCKETS)
        self._count += values.size
        self._total += int(values.sum())
        self._maximum = max(self._maximum, int(values.max()))

    @property
    def count(self) -> int:
        """Number of durations."""
        self._sort()
        return self._count

    @property
    def maximum(self) -> int:
        """The longest duration [ns]."""
        self._sort()
        return self._maximum

    def percentile(self, percent: float) -> int:
        """Return an upper bound [ns] of the given percentile, 0 while empty."""
        count = self.count
        if not count:
            return 0
        key = int(np.searchsorted(self._buckets.cumsum(), percent / 100.0 * count))
        return min(_upper(key), self._maximum)

    def summary(self) -> dict[str, int]:
        """Return count, mean, p50, p99 and maximum in ns."""
        count = self.count
        return {
            "count": count,
            "mean": self._total // count if count else 0,
            "p50": self.percentile(50),
            "p99": self.percentile(99),
            "max": self._maximum,
        }


def _upper(key: int) -> int:
    shift, mantissa = key >> (_SUB_BITS + 1), key & ((2 << _SUB_BITS) - 1)
    if shift == 0:
        return key
    return ((mantissa + 1) << shift) - 1


class Trace:
    """Pairs (stamp, time) at one point of the chain, for exact percentiles between two processes."""

    __slots__ = ("_pairs",)

    def __init__(self) -> None:
        self._pairs = bytearray()

    def mark(self, stamp: int, time_ns: int) -> None:
        """Note that the sample with this stamp passed at `time_ns`."""
        self._pairs += _PAIR.pack(stamp, time_ns)

    def to_dict(self) -> dict[str, list[int]]:
        """Return stamps and times in the order of the marks."""
        pairs = np.frombuffer(self._pairs, dtype=np.int64).reshape(-1, 2)
        return {"stamps": pairs[:, 0].tolist(), "times": pairs[:, 1].tolist()}


class Statistics:
    """Timing of one node.

    Attributes:
        wakeup: How much later than due a tick started.
        period: Time between two ticks.
        callback: Duration of the callback of a tick or message, by name.
        age: Time from the stamp of a sample to its arrival, by topic.
        lost_cycles: Ticks that were never run.
        overruns: Ticks that took longer than a period.
        dropped: Samples missing in a stream at the host rate.
        garbage: Messages that were no valid CDR, by topic.
    """

    def __init__(self) -> None:
        self.wakeup = Histogram()
        self.period = Histogram()
        self.callback: dict[str, Histogram] = {}
        self.age: dict[str, Histogram] = {}
        self.ticks = self.lost_cycles = self.overruns = 0
        self.dropped: dict[str, int] = {}
        self.garbage: dict[str, int] = {}
        self.traces: dict[str, Trace] | None = None

    def trace(self, point: str) -> Trace | None:
        """Return the trace of a point of the chain, or None when tracing is off."""
        return None if self.traces is None else self.traces.setdefault(point, Trace())

    def losses(self) -> int:
        """Return the number of lost cycles, lost samples and invalid messages."""
        return self.lost_cycles + sum(self.dropped.values()) + sum(self.garbage.values())

    def to_dict(self) -> dict[str, object]:
        """Return everything as plain data, durations in ns."""
        return {
            "ticks": self.ticks,
            "lost_cycles": self.lost_cycles,
            "overruns": self.overruns,
            "dropped": self.dropped,
            "garbage": self.garbage,
            "wakeup": self.wakeup.summary(),
            "period": self.period.summary(),
            "callback": {name: histogram.summary() for name, histogram in self.callback.items()},
            "age": {name: histogram.summary() for name, histogram in self.age.items()},
        }

    def counters(self) -> Iterator[tuple[str, str]]:
        """Yield the counters as key-value pairs of the diagnostics message."""
        yield "ticks", str(self.ticks)
        yield "lost_cycles", str(self.lost_cycles)
        yield "overruns", str(self.overruns)
        yield "dropped", str(sum(self.dropped.values()))
        yield "garbage", str(sum(self.garbage.values()))

    def percentiles(self) -> Iterator[tuple[str, str]]:
        """Yield the durations as key-value pairs of the diagnostics message in microseconds, one piece of work each."""
        histograms = {"wakeup": self.wakeup, "period": self.period}
        histograms.update({f"callback {name}": histogram for name, histogram in self.callback.items()})
        histograms.update({f"age {name}": histogram for name, histogram in self.age.items()})
        for name, histogram in histograms.items():
            if histogram.count:
                p50, p99 = histogram.percentile(50) / 1e3, histogram.percentile(99) / 1e3
                yield f"{name} [us] p50 p99 max", f"{p50:.0f} {p99:.0f} {histogram.maximum / 1e3:.0f}"

    def write(self, folder: Path, name: str) -> None:
        """Write statistics and traces as JSON to `folder/name.json`."""
        folder.mkdir(parents=True, exist_ok=True)
        traces = {point: trace.to_dict() for point, trace in (self.traces or {}).items()}
        (folder / f"{name}.json").write_text(json.dumps({"statistics": self.to_dict(), "traces": traces}))
