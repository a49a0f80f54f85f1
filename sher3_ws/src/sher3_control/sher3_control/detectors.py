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
    """Anything the supervisor can ask; `active_when_disabled` ones are asked in every state."""

    @property
    def active_when_disabled(self) -> bool:
        """Whether it objects in DISABLED too, as the emergency stop does."""

    def check(self, now: int) -> Finding | None:
        """Return the objection at time `now` [ns], or None."""


@dataclass
class SilenceDetector:
    """A stream that has gone silent: age of the newest sample against `limit` [s]."""

    source: str
    limit: float
    last: int = -1
    active_when_disabled: bool = False

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
class EmergencyStopDetector:
    """The latched button of the pedal box: 1 is pressed."""

    source: str = "pedal/measured"
    pressed: bool = False
    active_when_disabled: bool = True

    def feed(self, pressed: bool) -> None:
        """Take note of the button."""
        self.pressed = pressed

    def check(self, now: int) -> Finding | None:
        """Object while the button is pressed."""
        return Finding("EMERGENCY_STOP", 1.0, 0.0, "pressed", self.source) if self.pressed else None


@dataclass
class ReportedFault:
    """A fault that another node reports; it stays until that node reports it gone.

    The drives reset their fault only on the way from FAULT to DISABLED, so it must not stand in the way of that step:
    it is asked in ENABLED and PAUSED, and before `enable`.
    """

    source: str
    finding: Finding | None = None
    active_when_disabled: bool = False

    def feed(self, faulty: bool, message: str) -> None:
        """Take note of a report; `message` says what is wrong."""
        source = f"{self.source}: {message}"
        self.finding = Finding(f"{code_of(self.source)}_STOPPED", 1.0, 0.0, "reported", source) if faulty else None

    def check(self, now: int) -> Finding | None:
        """Object while the report stands."""
        return self.finding


def code_of(source: str) -> str:
    """Return the reason-code form of a topic name: `force/measured_cf` is `FORCE_MEASURED_CF`."""
    return source.replace("/", "_").upper()
