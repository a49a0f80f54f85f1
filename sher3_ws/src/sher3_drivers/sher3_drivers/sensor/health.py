"""The sensor's health: does this record come from a force sensor that works? Pure functions over records.

This is a judgement of the device. Its limits are those of a device that is broken: twice the rated range, which no true
reading exceeds, and eight records in a row that repeat bit for bit. Whether a robot may move on a wrench is judged
apart from it, by the control law (`sher3_control.law.wrench_gate`). The gate has tighter limits, the rated range
itself, saturation a little below it and six repetitions: a false objection there costs a pause, and here it would
call a good sensor defective.
"""

from __future__ import annotations

import math
from collections import Counter
from enum import Enum
from typing import NamedTuple

from sher3_common.reasons import Reason, reading
from sher3_common.vectors import ZERO_WRENCH, Wrench
from sher3_description import ForceSensor

from sher3_drivers.sensor.device import WrenchRecord


class SensorFault(Enum):
    """What is wrong with the stream of records; the value is the sentence for the log."""

    NONE = "ok"
    SILENT = "no record arrived in time"
    DEVICE = "the sensor reports an error in its status word"
    SEQUENCE = "records were lost or came out of order"
    NOT_FINITE = "a component is NaN or infinite"
    OUT_OF_RANGE = "a component is beyond what the sensor can read"
    SATURATED = "a component reached the rated range"
    ABSURD = "the force jumps to and fro faster than any hand"
    FROZEN = "bit-identical readings in a row: a live sensor has noise"

    @property
    def severe(self) -> bool:
        """Whether the sensor cannot be used in this tick; lost records alone are reported and do no harm."""
        return self not in (SensorFault.NONE, SensorFault.SEQUENCE)


class SensorLimits(NamedTuple):
    """What the records of a working sensor satisfy.

    Attributes:
        rated: rated range (6,), N and N m; reaching it is saturation.
        overload: multiple of the rated range that no true reading exceeds, 1.
        frozen: number of bit-identical readings in a row that make a frozen sensor, 1. The noise of the nominal sensor
            repeats all six components with a chance of about 2e-4 a sample: eight in a row do not occur in its life.
        jump: change of a component between two records that counts as a jump, as a share of the rated range: 3 N.
        jumps: number of jumps of one component within `span` records, each against the one before, that no hand makes.
            A hit on the tool is two, up and down. A firm push that is turned round within 25 ms is one: it goes on in
            one direction for several records.
        span: number of records, 50 ms at 500 Hz: a sine that jumps at all, one of 20 Hz or more, turns twice in it.
    """

    rated: tuple[float, ...]
    overload: float = 2.0
    frozen: int = 8
    jump: float = 0.25
    jumps: int = 3
    span: int = 25

    @classmethod
    def of(cls, sensor: ForceSensor) -> SensorLimits:
        """Return the limits of a sensor."""
        return cls((*sensor.range_force, *sensor.range_torque))


class Jump(NamedTuple):
    """A component that jumped: its index, whether it went up, and how many records ago."""

    component: int
    up: bool
    age: int


class SensorHealth(NamedTuple):
    """What is remembered of the records so far.

    Attributes:
        last: newest record, None before the first.
        repeats: how often its wrench has repeated in a row.
        lost: number of records that never arrived.
        jumped: the jumps of the newest `span` records that went against the one before, newest last.
    """

    last: WrenchRecord | None = None
    repeats: int = 0
    lost: int = 0
    jumped: tuple[Jump, ...] = ()


def judge_record(
    health: SensorHealth, record: WrenchRecord | None, limits: SensorLimits
) -> tuple[SensorHealth, SensorFault]:
    """Judge the record of a tick.

    Args:
        health: what is remembered of the records so far.
        record: the record, None when none came in time.
        limits: limits of the sensor.

    Returns:
        What to remember, and the gravest fault.
    """
    if record is None:
        return health, SensorFault.SILENT
    last = health.last
    repeats = health.repeats + 1 if last is not None and record.wrench == last.wrench else 0
    in_order = last is None or _follows(record.sequence, last.sequence)
    lost = health.lost
    if last is not None and in_order:
        lost += _steps(record.sequence, last.sequence) - record.drained
    jumped = health.jumped if last is None else _turns(health.jumped, record.wrench, last.wrench, limits)
    health = SensorHealth(record, repeats, lost, jumped)
    if record.status:
        return health, SensorFault.DEVICE
    magnitude = _magnitude_fault(record.wrench, limits)
    if magnitude is not SensorFault.NONE:
        return health, magnitude
    if len(jumped) >= limits.jumps and _to_and_fro(jumped) >= limits.jumps:
        return health, SensorFault.ABSURD
    if repeats + 1 >= limits.frozen:
        return health, SensorFault.FROZEN
    lost_now = last is not None and _steps(record.sequence, last.sequence) != record.drained
    return health, SensorFault.SEQUENCE if lost_now or not in_order else SensorFault.NONE


def _magnitude_fault(wrench: Wrench, limits: SensorLimits) -> SensorFault:
    """Judge the numbers of one wrench."""
    if not all(map(math.isfinite, wrench)):
        return SensorFault.NOT_FINITE
    # A list: a generator costs twice as much, a thousand times a second.
    share = max([abs(value) / rated for value, rated in zip(wrench, limits.rated, strict=True)])
    if share > limits.overload:
        return SensorFault.OUT_OF_RANGE
    return SensorFault.SATURATED if share >= 1.0 else SensorFault.NONE


def _turns(jumped: tuple[Jump, ...], wrench: Wrench, last: Wrench, limits: SensorLimits) -> tuple[Jump, ...]:
    """Return the jumps to remember; one in the direction of the one before is the same movement, and not counted.

    What is not finite is judged elsewhere.
    """
    if jumped:
        jumped = tuple([jump._replace(age=jump.age + 1) for jump in jumped if jump.age + 1 < limits.span])
    steps = [(new - old) / rated for new, old, rated in zip(wrench, last, limits.rated, strict=True)]
    if max(steps) <= limits.jump and min(steps) >= -limits.jump:
        return jumped
    heading = {jump.component: jump.up for jump in jumped}
    return jumped + tuple(
        [
            Jump(component, step > 0.0, 0)
            for component, step in enumerate(steps)
            if abs(step) > limits.jump and heading.get(component) is not (step > 0.0)
        ]
    )


def _to_and_fro(jumped: tuple[Jump, ...]) -> int:
    """Return the most jumps of one component."""
    return max(Counter([jump.component for jump in jumped]).values())


def sensor_readings(health: SensorHealth, limits: SensorLimits) -> list[tuple[str, str]]:
    """Return the largest component and the repetitions with their limits, for the diagnostics."""
    wrench = ZERO_WRENCH if health.last is None else health.last.wrench
    share = max(abs(value) / rated for value, rated in zip(wrench, limits.rated, strict=True))
    return [
        reading(Reason.WRENCH_OUT_OF_RANGE, "sensor", share, limits.overload, "of the range"),
        reading(Reason.WRENCH_FROZEN, "sensor", health.repeats + 1, limits.frozen, "samples"),
    ]


def _steps(sequence: int, last: int) -> int:
    """Return how far a 32-bit counter went, modulo its range."""
    return sequence - last & 0xFFFFFFFF


def _follows(sequence: int, last: int) -> bool:
    """Return whether a 32-bit counter went forward: by less than half its range, across the wrap-around too."""
    return 0 < _steps(sequence, last) < 1 << 31
