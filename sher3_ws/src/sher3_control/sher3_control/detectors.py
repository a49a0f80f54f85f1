"""Detectors: small objects that look at one number with a unit and a limit, and object with a reason.

A detector is fed by its stream and asked by the supervisor; new ones are new classes with `check(now) -> Finding |
None`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True)
class Finding:
    """What a detector objects to.

    Attributes:
        code: reason code such as `FORCE_SILENT`, stable across versions.
        value, limit: the number and its limit in `unit`.
        source: stream or component.
    """

    code: str
    value: float
    limit: float
    unit: str
    source: str

    def __str__(self) -> str:
        return f"{self.code}: {self.source} {self.value:.6g} {self.unit}, limit {self.limit:.6g} {self.unit}"


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


class _Plain:
    """Defaults of a detector whose cause comes and goes by itself."""

    active_when_disabled = False
    cleared_by_recovery = False

    def recover(self, now: int) -> None:
        """Nothing to forget."""


@dataclass
class SilenceDetector(_Plain):
    """A stream that has gone silent: age of the newest sample against `limit` [s]."""

    source: str
    limit: float
    last: int = -1

    def feed(self, stamp: int) -> None:
        """Take note of a sample [ns]."""
        self.last = stamp

    def check(self, now: int) -> Finding | None:
        """Object when no sample came within the limit, or none at all."""
        age = (now - self.last) * 1e-9 if self.last >= 0 else float("inf")
        if age <= self.limit:
            return None
        return Finding(code_of(self.source) + "_SILENT", age, self.limit, "s", self.source)


@dataclass
class EmergencyStopDetector(_Plain):
    """The latched button of the pedal box: 1 is pressed."""

    source: str = "pedal/measured"
    pressed: bool = False
    active_when_disabled = True

    def feed(self, pressed: bool) -> None:
        """Take note of the button."""
        self.pressed = pressed

    def check(self, now: int) -> Finding | None:
        """Object while the button is pressed."""
        return Finding("EMERGENCY_STOP", 1.0, 0.0, "pressed", self.source) if self.pressed else None


@dataclass
class ReportedFault(_Plain):
    """A fault that the motor driver reports; it stays until the driver reports it gone.

    Driver and drives reset only on the way from FAULT to DISABLED. Reports made before they have done so are not
    taken up again: for `grace` [s] after the recovery a report counts as an old one.
    """

    source: str
    grace: float = 0.5
    finding: Finding | None = None
    deaf_until: int = -1
    active_when_disabled = True
    cleared_by_recovery = True

    def feed(self, faulty: bool, message: str, now: int) -> None:
        """Take note of a report at `now` [ns]; `message` says what is wrong."""
        if not faulty:
            self.finding, self.deaf_until = None, -1
        elif now > self.deaf_until:
            source = f"{self.source}: {message}"
            self.finding = Finding(f"{code_of(self.source)}_STOPPED", 1.0, 0.0, "reported", source)

    def check(self, now: int) -> Finding | None:
        """Object while the report stands."""
        return self.finding

    def recover(self, now: int) -> None:
        """Wait for the first report after the reset."""
        self.finding, self.deaf_until = None, now + round(self.grace * 1e9)


def code_of(source: str) -> str:
    """Return the reason-code form of a topic name: `force/measured_cf` is `FORCE_MEASURED_CF`."""
    return source.replace("/", "_").upper()
