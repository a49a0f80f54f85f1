"""Detectors: small objects that look at one number with a unit and a limit, and object with a reason.

A detector is fed by its stream and asked by the supervisor; new ones are new classes with `check(now) -> Finding |
None`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

from .reasons import ACTION, Action, Reason


class Finding(NamedTuple):
    """What a detector objects to.

    Attributes:
        reason: the cause, stable across versions.
        value, limit: the number and its limit in `unit`.
        source: stream or component.
        harder: an action beyond what the reason asks for, as the motor driver may report one.
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

    def __str__(self) -> str:
        return f"{self.code}: {self.source} {self.value:.6g} {self.unit}, limit {self.limit:.6g} {self.unit}"

    def to_dict(self) -> dict[str, object]:
        """Return it as plain data."""
        numbers = {"value": self.value, "limit": self.limit, "unit": self.unit, "source": self.source}
        return {"code": self.code, **numbers, "action": self.action.name}


class Detector(Protocol):
    """Anything the supervisor can ask."""

    @property
    def active_when_disabled(self) -> bool:
        """Whether it leads from DISABLED into FAULT too, as the emergency stop does."""

    @property
    def cleared_by_recovery(self) -> bool:
        """Whether its cause can only go on the way from FAULT to DISABLED, and so must not bar it."""

    def recover(self, now: int) -> None:
        """Take note of that way being gone at `now` [ns]."""

    def check(self, now: int) -> Finding | None:
        """Return the objection at time `now` [ns], or None."""

    def look(self, now: int) -> Finding:
        """Return the number it looks at, objectionable or not, for the diagnostics."""


class _Plain:
    """Defaults of a detector whose cause comes and goes by itself."""

    active_when_disabled = False
    cleared_by_recovery = False

    def recover(self, now: int) -> None:
        """Nothing to forget."""

    def look(self, now: int) -> Finding:
        raise NotImplementedError

    def check(self, now: int) -> Finding | None:
        """Object while the number is beyond its limit; a NaN is."""
        found = self.look(now)
        return None if found.value <= found.limit else found


@dataclass
class SilenceDetector(_Plain):
    """A stream that has gone silent: age of the newest sample against `limit` [s]."""

    source: str
    limit: float
    missing: Reason
    stale: Reason
    last: int = -1

    def feed(self, stamp: int) -> None:
        """Take note of a sample [ns]."""
        self.last = stamp

    def look(self, now: int) -> Finding:
        """Return the age; infinite before the first sample."""
        if self.last < 0:
            return Finding(self.missing, float("inf"), self.limit, "s", self.source)
        return Finding(self.stale, (now - self.last) * 1e-9, self.limit, "s", self.source)


@dataclass
class EmergencyStopDetector(_Plain):
    """The latched button of the pedal box: 1 is pressed."""

    source: str = "pedal/measured"
    pressed: bool = False
    active_when_disabled = True

    def feed(self, pressed: bool) -> None:
        """Take note of the button."""
        self.pressed = pressed

    def look(self, now: int) -> Finding:
        """Return the button."""
        return Finding(Reason.EMERGENCY_STOP, float(self.pressed), 0.0, "pressed", self.source)


@dataclass
class ReportedFault(_Plain):
    """A stop that the motor driver reports; it stays until the driver reports it gone.

    Driver and drives reset only on the way from FAULT to DISABLED. Reports made before they have done so are not
    taken up again: for `grace` [s] after the recovery a report counts as an old one.
    """

    source: str
    grace: float = 0.5
    finding: Finding | None = None
    deaf_until: int = -1
    active_when_disabled = True
    cleared_by_recovery = True

    def feed(self, report: Finding | None, now: int) -> None:
        """Take note of a report at `now` [ns], None when nothing is wrong."""
        if report is None:
            self.finding, self.deaf_until = None, -1
        elif now > self.deaf_until:
            self.finding = report

    def look(self, now: int) -> Finding:
        """Return the report that stands, or that there is none."""
        return self.finding or Finding(Reason.MOVING, 0.0, 0.0, "reported", self.source)

    def check(self, now: int) -> Finding | None:
        """Object while the report stands."""
        return self.finding

    def recover(self, now: int) -> None:
        """Wait for the first report after the reset."""
        self.finding, self.deaf_until = None, now + round(self.grace * 1e9)


@dataclass
class OverrunDetector(_Plain):
    """Nodes that lose cycles or overrun them: the worst node's share of bad cycles between its last two reports.

    A report counts for `lifetime` [s]; the first one of a node holds its start and does not count.
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
        """Return the worst node."""
        oldest = now - round(self.lifetime * 1e9)
        fresh = [(share, node) for node, (share, at) in self._share.items() if at >= oldest]
        share, node = max(fresh, default=(0.0, "control loop"))
        return Finding(Reason.OVERRUN, share, self.limit, "of the cycles", node)


@dataclass
class TwinDetector(_Plain):
    """A second publisher of a stream that is the robot's own: one of its processes runs twice, or somebody imitates it.

    The samples of both would be taken in turn, each with its right to be believed.
    """

    limit: int = 1
    counts: dict[str, int] = field(default_factory=dict)

    def feed(self, counts: Mapping[str, int]) -> None:
        """Take note of how many publishers these streams have; those of others stay as they were."""
        self.counts.update(counts)

    def look(self, now: int) -> Finding:
        """Return the stream with the most publishers."""
        source = max(self.counts, key=lambda name: self.counts[name], default="robot's own streams")
        return Finding(Reason.PUBLISHED_TWICE, self.counts.get(source, 0), self.limit, "publishers", source)
