"""Detectors: each looks at one number with a unit and a limit, and objects with a reason.

A stream feeds a detector, and the supervisor asks it. A new detector is a new class that fits `Detector`; it gets most
of it from `PlainDetector`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

from sher3_common.reasons import ACTION, Action, Reason
from sher3_common.remedies import remedy
from sher3_common.stamps import age, nanoseconds


class Finding(NamedTuple):
    """What a detector sees, and objects to where the value is beyond the limit.

    Attributes:
        reason: the cause; its name never changes.
        value, limit: the number and its limit in `unit`.
        source: stream or component.
        harder: a harder action than the reason asks for, which the motor driver may report.
    """

    reason: Reason
    value: float
    limit: float
    unit: str
    source: str
    harder: Action = Action.NONE

    @property
    def code(self) -> str:
        """The reason's name."""
        return self.reason.name

    @property
    def action(self) -> Action:
        """How hard the robot is stopped for it."""
        return max(ACTION[self.reason], self.harder)

    @property
    def remedy(self) -> str:
        """What the user does about it."""
        return remedy(self.reason, self.source)

    def __str__(self) -> str:
        return f"{self.code}: {self.source} {self.value:.6g} {self.unit}, limit {self.limit:.6g} {self.unit}"

    def to_dict(self) -> dict[str, object]:
        """Return the finding as plain data."""
        numbers = {"value": self.value, "limit": self.limit, "unit": self.unit, "source": self.source}
        return {"code": self.code, **numbers, "action": self.action.name, "remedy": self.remedy}


class Detector(Protocol):
    """Anything that the supervisor can ask."""

    @property
    def active_when_disabled(self) -> bool:
        """Whether its objection leads from DISABLED into FAULT too, as that of the emergency stop does."""

    @property
    def cleared_by_recovery(self) -> bool:
        """Whether its cause goes only when FAULT is left for DISABLED, so that it must not bar that change."""

    def recover(self, now: int) -> None:
        """Take note that FAULT is left for DISABLED at `now` [ns]."""

    def check(self, now: int) -> Finding | None:
        """Return the objection at the time `now` [ns], or None."""

    def look(self, now: int) -> Finding:
        """Return the number that it looks at, whether it objects or not, for the diagnostics."""


class PlainDetector:
    """Base of a detector whose cause comes and goes by itself; a subclass says what it looks at."""

    active_when_disabled = False
    cleared_by_recovery = False

    def recover(self, now: int) -> None:
        """There is nothing to forget."""

    def look(self, now: int) -> Finding:
        """Return the number with its limit at the time `now` [ns]."""
        raise NotImplementedError

    def check(self, now: int) -> Finding | None:
        """Object while the number is beyond its limit; a NaN is beyond every limit."""
        found = self.look(now)
        return None if found.value <= found.limit else found


@dataclass
class SilenceDetector(PlainDetector):
    """A stream that has gone silent: the age of its newest sample is beyond the limit.

    Attributes:
        source: the stream.
        limit: oldest newest sample [s].
        missing: reason when no sample ever came.
        stale: reason when the newest sample is too old.
        last: stamp of the newest sample [ns], -1 without one.
    """

    source: str
    limit: float
    missing: Reason
    stale: Reason
    last: int = -1

    def feed(self, stamp: int) -> None:
        """Take note of the stamp of a sample [ns]."""
        self.last = stamp

    def look(self, now: int) -> Finding:
        """Return the age of the newest sample; it is infinite before the first one."""
        reason = self.missing if self.last < 0 else self.stale
        return Finding(reason, age(now, self.last), self.limit, "s", self.source)


@dataclass
class EmergencyStopDetector(PlainDetector):
    """The latched stop button of the pedal box; the number is 1 while it is pressed."""

    source: str = "pedal/measured"
    pressed: bool = False
    active_when_disabled = True

    def feed(self, pressed: bool) -> None:
        """Take note of whether the button is pressed."""
        self.pressed = pressed

    def look(self, now: int) -> Finding:
        """Return the state of the button."""
        return Finding(Reason.EMERGENCY_STOP, float(self.pressed), 0.0, "pressed", self.source)


@dataclass
class PedalFormDetector(PlainDetector):
    """A message on the pedal's stream that is no pedal's: it has one axis and one button, the emergency stop.

    A pedal without a button cannot say that the stop is not pressed, and of a gamepad's buttons none is the stop.

    Attributes:
        axes, buttons: numbers of them in the newest message.
    """

    source: str = "pedal/measured"
    axes: int = 1
    buttons: int = 1

    def feed(self, axes: int, buttons: int) -> None:
        """Take note of the form of a message."""
        self.axes, self.buttons = axes, buttons

    def look(self, now: int) -> Finding:
        """Return the number that is wrong; that of the buttons where none is."""
        count, unit = (self.axes, "axes") if self.axes != 1 else (self.buttons, "buttons")
        return Finding(Reason.PEDAL_INVALID, count, 1, unit, self.source)

    def check(self, now: int) -> Finding | None:
        """Object to any number but one."""
        found = self.look(now)
        return None if found.value == found.limit else found


@dataclass
class ReportedFault(PlainDetector):
    """A stop that the motor driver reports; it stays until the driver reports that it is over.

    Driver and drives reset only when FAULT is left for DISABLED. A report that comes shortly after that may have been
    made before the reset, so it does not count.

    Attributes:
        source: the component that reports.
        grace: how long after the recovery reports do not count [s].
        finding: the stop that is reported, None without one.
        deaf_until: end of the grace time [ns].
    """

    source: str
    grace: float = 0.5
    finding: Finding | None = None
    deaf_until: int = -1
    active_when_disabled = True
    cleared_by_recovery = True

    def feed(self, report: Finding | None, now: int) -> None:
        """Take note of a report at `now` [ns]; None says that nothing is wrong."""
        if report is None:
            self.finding, self.deaf_until = None, -1
        elif now > self.deaf_until:
            self.finding = report

    def look(self, now: int) -> Finding:
        """Return the stop that is reported; without one the reason is MOVING."""
        return self.finding or Finding(Reason.MOVING, 0.0, 0.0, "reported", self.source)

    def check(self, now: int) -> Finding | None:
        """Object while a stop is reported."""
        return self.finding

    def recover(self, now: int) -> None:
        """Forget the stop, and begin the grace time."""
        self.finding, self.deaf_until = None, now + nanoseconds(self.grace)


@dataclass
class OverrunDetector(PlainDetector):
    """Nodes that lose cycles or overrun them: the largest share of bad cycles of a node between its last two reports.

    The first report of a node covers its start, which is slow, and does not count.

    Attributes:
        limit: share of the cycles [1].
        lifetime: how long a report counts [s].
    """

    limit: float
    lifetime: float = 2.5
    _before: dict[str, tuple[int, int]] = field(default_factory=dict)
    _share: dict[str, tuple[float, int]] = field(default_factory=dict)

    def feed(self, node: str, ticks: int, bad: int, now: int) -> None:
        """Take note of a node's counters at `now` [ns]: cycles due, and cycles lost or too long."""
        before = self._before.get(node)
        self._before[node] = ticks, bad
        if before is not None and ticks > before[0]:
            self._share[node] = (bad - before[1]) / (ticks - before[0]), now

    def look(self, now: int) -> Finding:
        """Return the node with the largest share."""
        oldest = now - nanoseconds(self.lifetime)
        fresh = [(share, node) for node, (share, at) in self._share.items() if at >= oldest]
        share, node = max(fresh, default=(0.0, "control loop"))
        return Finding(Reason.OVERRUN, share, self.limit, "of the cycles", node)


@dataclass
class TwinDetector(PlainDetector):
    """A second publisher of one of the robot's own streams: a process runs twice, or somebody imitates it.

    Each sample of either publisher would be believed, so the robot would follow both in turn.

    Attributes:
        limit: publishers that a stream may have.
        counts: number of publishers by stream.
    """

    limit: int = 1
    counts: dict[str, int] = field(default_factory=dict)

    def feed(self, counts: Mapping[str, int]) -> None:
        """Take note of the numbers of publishers of some streams; the other streams keep theirs."""
        self.counts.update(counts)

    def look(self, now: int) -> Finding:
        """Return the stream with the most publishers."""
        source = max(self.counts, key=lambda name: self.counts[name], default="robot's own streams")
        return Finding(Reason.PUBLISHED_TWICE, self.counts.get(source, 0), self.limit, "publishers", source)
