"""Count the samples missing from a source that should have one at every point of a time grid."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray
from sher3_common.stamps import SECOND
from sher3_description import TOPICS, Robot
from sher3_description.topics import MANY_SENDERS

from sher3_bags.messages import TEXT
from sher3_bags.run import CONTRACT_TOPICS

PAUSE_NS = 250_000_000
"""A gap longer than this [ns] means that the source was switched off (`servo_cv` outside cooperative mode); it is not a
loss of samples."""


def is_stamped(topic: str) -> bool:
    """Return whether the stamps of a topic's messages are in an order that can be judged.

    Stamps of different senders repeat and overtake each other. Where the order tells nothing, only the times of arrival
    can be judged.
    """
    return topic not in MANY_SENDERS and TOPICS[topic].type != TEXT


def grid_periods(robot: Robot) -> dict[str, int]:
    """Return the period [ns] of every topic that the contract puts on a grid (section 4)."""
    host = round(robot.control_period * 1e9)
    others = {"tracker/measured_cp": round(1e9 / robot.tracker.rate), "temperature": SECOND}
    return {topic: others.get(topic, host) for topic in CONTRACT_TOPICS if topic != "operating_state"}


@dataclass(slots=True)
class GapCounter:
    """Counts of one source.

    Attributes:
        period: Period of the grid [ns]; None for a source without a grid.
        stamped: True when it sees stamps of the source; False when it sees times of arrival, which may repeat.
        messages: Samples seen.
        dropped: Grid points without a sample, in gaps of at most `PAUSE_NS`.
        pauses: Gaps longer than `PAUSE_NS`.
        disordered: Samples whose stamp repeats or goes backwards.
        longest: Longest gap between two samples [ns].
    """

    period: int | None = None
    stamped: bool = True
    messages: int = 0
    dropped: int = 0
    pauses: int = 0
    disordered: int = 0
    longest: int = 0
    last: int | None = None

    def see(self, stamp: int) -> None:
        """Count the sample with this stamp, or time of arrival [ns]."""
        self.messages += 1
        if self.last is not None:
            step = stamp - self.last
            if 0 < step <= self.longest and (step == self.period or self.period is None):  # nearly always
                self.last = stamp
                return
            if step <= 0:
                self.disordered += self.stamped or step < 0
                return
            self.longest = max(self.longest, step)
            if self.period is not None:
                if step > max(PAUSE_NS, 3 * self.period):
                    self.pauses += 1
                else:
                    self.dropped += max(0, round(step / self.period) - 1)
        self.last = stamp

    def counts(self) -> dict[str, int]:
        """Return the counts as plain data."""
        return {key: value for key, value in asdict(self).items() if key not in ("period", "stamped", "last")}


def count_gaps(stamp: NDArray[np.int64], period: int | None, stamped: bool = True) -> GapCounter:
    """Return the counts of a whole recorded stream, as a `GapCounter` makes them that sees its stamps."""
    counter = GapCounter(period, stamped, messages=len(stamp))
    highest = np.maximum.accumulate(stamp) if len(stamp) else stamp
    ahead = stamp[1:] - highest[:-1]
    counter.disordered = int((ahead <= 0 if stamped else ahead < 0).sum())
    step = np.diff(stamp[np.r_[True, ahead > 0]]) if len(stamp) else ahead
    counter.longest = int(step.max(initial=0))
    counter.last = int(highest[-1]) if len(stamp) else None
    if period is not None:
        pause = step > max(PAUSE_NS, 3 * period)
        counter.pauses = int(pause.sum())
        missing = np.rint(step[~pause] / period).astype(np.int64) - 1
        counter.dropped = int(missing.clip(0).sum())
    return counter
