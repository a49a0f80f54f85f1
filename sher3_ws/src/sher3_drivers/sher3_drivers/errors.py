"""Typed errors of the drivers; each carries value, limit and remedy (`sher3_common.errors`)."""

from __future__ import annotations

from typing import Any

from sher3_common import Sher3Error


class DriverError(Sher3Error):
    """Base of everything the drivers raise."""


class FrameError(DriverError):
    """Bytes are no CAN frames, or a frame does not carry what it should."""


class LinkError(DriverError):
    """A CAN link cannot be opened or used; carries `link`."""

    def __init__(self, what: str, *, link: str, **details: Any) -> None:
        super().__init__(f"CAN link {link}: {what}", **details)
        self.link = link


class BusLoadError(DriverError):
    """The configured cycle does not fit the bus; carries the `budget` it computed."""

    def __init__(self, what: str, *, budget: str, **details: Any) -> None:
        super().__init__(what, **details)
        self.budget = budget

    def __str__(self) -> str:
        return f"{super().__str__()}\n{self.budget}"


class UnknownStatusword(DriverError):
    """A statusword encodes no CiA 402 state."""


class ScaleError(DriverError):
    """A value does not fit its CAN object, or a resolution is no whole number of increments."""


class DriverSettingsError(DriverError):
    """Settings of the motor driver are out of range or inconsistent with each other."""


class DriveMismatch(DriverError):
    """A drive's objects do not hold what they must; carries `drive` and `mismatches` (object, expected, found)."""

    def __init__(self, drive: str, mismatches: list[tuple[str, object, object]]) -> None:
        text = "; ".join(f"object {name}: expected {expected}, found {found}" for name, expected, found in mismatches)
        super().__init__(
            f"drive {drive} is not configured as the driver needs it: {text}",
            remedy="correct the drive's configuration or the robot file; nothing was enabled",
        )
        self.drive = drive
        self.mismatches = mismatches


class DriveSilent(DriverError):
    """A drive does not answer; carries `drive`."""

    def __init__(self, drive: str, what: str, **details: Any) -> None:
        super().__init__(f"drive {drive}: {what}", **details)
        self.drive = drive


class OtherHost(DriverError):
    """Another host commands the drives of this bus already; carries `link`. Nothing was sent."""

    def __init__(self, link: str, said: str) -> None:
        remedy = "end the other motor driver, or give this one another bus; nothing was sent"
        super().__init__(f"CAN link {link}: there is another host", value=said, limit="one on a bus", remedy=remedy)
        self.link = link


class CommandRefused(DriverError):
    """A request or velocity command must not reach the drives; for a command, zero velocity was sent instead."""


class DeviceMissing(DriverError):
    """A sensor or pedal is not there or was lost; carries `device`."""

    def __init__(self, device: str, what: str, **details: Any) -> None:
        super().__init__(f"{device}: {what}", **details)
        self.device = device
