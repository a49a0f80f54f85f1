"""Is a force reading to be believed? Pure functions over records, with typed results and time as an argument."""

from __future__ import annotations

import math
from enum import Enum
from typing import NamedTuple

from sher3_description import ForceSensor
from sher3_description.reasons import Reason, reading

from .force_sensor import WrenchRecord


class WrenchFault(Enum):
    """What is wrong with the force stream; the value is the sentence for the log."""

    NONE = "ok"
    SILENT = "no record arrived in time"
    DEVICE = "the sensor reports an error in its status word"
    SEQUENCE = "records were lost or came out of order"
    NOT_FINITE = "a component is NaN or infinite"
    OUT_OF_RANGE = "a component is beyond what the sensor can read"
    SATURATED = "a component reached the rated range"
    FROZEN = "bit-identical readings in a row: a live sensor has noise"

    @property
    def severe(self) -> bool:
        """Whether motion on this reading must stop (lost records alone are only reported)."""
        return self not in (WrenchFault.NONE, WrenchFault.SEQUENCE)


class WrenchLimits(NamedTuple):
    """What a believable reading satisfies.

    Attributes:
        rated: rated range (6,), N and N m; reaching it is saturation.
        overload: multiple of the rated range that no true reading exceeds.
        frozen: number of bit-identical readings in a row that make a frozen sensor. The noise of the nominal sensor
            repeats all six components with a chance of about 2e-4 a sample, eight in a row never in its life.
    """

    rated: tuple[float, ...]
    overload: float = 2.0
    frozen: int = 8

    @classmethod
    def of(cls, sensor: ForceSensor) -> WrenchLimits:
        """Return the limits of a sensor."""
        return cls((*sensor.range_force, *sensor.range_torque))


class WrenchWatch(NamedTuple):
    """What the checks remember: the newest record and how often its wrench repeated."""

    last: WrenchRecord | None = None
    repeats: int = 0
    lost: int = 0


def check_wrench(
    watch: WrenchWatch, record: WrenchRecord | None, limits: WrenchLimits
) -> tuple[WrenchWatch, WrenchFault]:
    """Judge one tick's record, None when none came; return what to remember and the gravest fault."""
    if record is None:
        return watch, WrenchFault.SILENT
    last = watch.last
    repeats = watch.repeats + 1 if last is not None and record.wrench == last.wrench else 0
    in_order = last is None or _follows(record.sequence, last.sequence)
    lost = watch.lost
    if last is not None and in_order:
        lost += (record.sequence - last.sequence & 0xFFFFFFFF) - record.drained
    watch = WrenchWatch(record, repeats, lost)
    if record.status:
        return watch, WrenchFault.DEVICE
    magnitude = _magnitude_fault(record.wrench, limits)
    if magnitude is not WrenchFault.NONE:
        return watch, magnitude
    if repeats + 1 >= limits.frozen:
        return watch, WrenchFault.FROZEN
    lost_now = last is not None and (record.sequence - last.sequence & 0xFFFFFFFF) != record.drained
    return watch, WrenchFault.SEQUENCE if lost_now or not in_order else WrenchFault.NONE


def _magnitude_fault(wrench: tuple[float, ...], limits: WrenchLimits) -> WrenchFault:
    if not all(map(math.isfinite, wrench)):
        return WrenchFault.NOT_FINITE
    # A list: a generator costs twice as much, a thousand times a second.
    share = max([abs(value) / rated for value, rated in zip(wrench, limits.rated, strict=True)])
    if share > limits.overload:
        return WrenchFault.OUT_OF_RANGE
    return WrenchFault.SATURATED if share >= 1.0 else WrenchFault.NONE


def wrench_readings(watch: WrenchWatch, limits: WrenchLimits) -> list[tuple[str, str]]:
    """Return what is looked at now, with its limits, for the diagnostics."""
    wrench = (0.0,) * 6 if watch.last is None else watch.last.wrench
    share = max(abs(value) / rated for value, rated in zip(wrench, limits.rated, strict=True))
    return [
        reading(Reason.WRENCH_OUT_OF_RANGE, "sensor", share, limits.overload, "of the range"),
        reading(Reason.WRENCH_FROZEN, "sensor", watch.repeats + 1, limits.frozen, "samples"),
    ]


def _follows(sequence: int, last: int) -> bool:
    """Whether a 32-bit counter went forward, with wrap-around."""
    return 0 < (sequence - last & 0xFFFFFFFF) < 0x80000000
