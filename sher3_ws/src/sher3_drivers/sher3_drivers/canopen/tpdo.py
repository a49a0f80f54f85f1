"""The TPDOs of one tick: frames in, one feedback in SI units out when all are there, and the missing ones by name."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from operator import mul, sub
from typing import NamedTuple

from sher3_common.reasons import Reason
from sher3_common.vectors import Vector

from sher3_drivers.bus.frame import BUNDLED, FRAME_SIZE, HEADER_FORMAT, check_frames
from sher3_drivers.bus.load import CHECK_BYTES, TPDO_BYTES
from sher3_drivers.canopen.objects import CHECK_BASE, TPDO_BASES
from sher3_drivers.canopen.protection import OLDEST_REPORT, check_of, count_before
from sher3_drivers.units import AxisScale

_LENGTHS = (*TPDO_BYTES, CHECK_BYTES)
"""Bytes of every TPDO."""
TPDO1_DATA = struct.Struct("<iHh")
"""Load encoder, statusword, torque: the mapping of `objects.TPDO1`."""
TPDO2_DATA = struct.Struct("<ii")
"""Motor encoder, velocity demand: the mapping of `objects.TPDO2`."""
_REPORT = struct.Struct("<iHhii")
"""The data of both."""
CHECK_DATA = struct.Struct("<H")
"""Check of both: the mapping of `objects.TPDO3`."""


class DriveFeedback(NamedTuple):
    """What the five drives said at a SYNC; vectors (5,) in the order of ACTUATORS.

    Attributes:
        stamp: tick, ns.
        load_position: load encoders, m or rad.
        motor_position: motor encoders, m or rad.
        motor_velocity: difference of two readings of the motor encoder over the time between them, m/s or rad/s; 0 at
            the first tick.
        effort: reported force or torque, N or N m.
        velocity_demand: demand the drives executed in the interval that ended at the stamp, m/s or rad/s.
    """

    stamp: int
    load_position: Vector
    motor_position: Vector
    motor_velocity: Vector
    effort: Vector
    velocity_demand: Vector


class Invalid(NamedTuple):
    """Why the newest report of a drive was not believed.

    Attributes:
        reason: FEEDBACK_STALE, FEEDBACK_SWAPPED, FEEDBACK_GARBLED, DRIVE_TWICE where two reports contradict, or
            DRIVE_SILENT where there is none.
        text: a sentence without the drive's name.
        times: such ticks in a row.
    """

    reason: Reason
    text: str
    times: int


class TpdoCollector:
    """Sorts the frames of a tick by drive and PDO, and believes those that are whole, of their drive and of this SYNC.

    Args:
        scales: scales of the five axes.
        node_ids: CANopen node ids of the five drives, in the same order.
        period: control period, s.
        channels: number of the channel of every drive, in the same order; by default it does not matter.
        protected: every drive sends a check behind its two reports (`canopen.protection`).

    Attributes:
        statuswords: newest statusword of every drive, None before the first.
        duplicates: number of TPDOs that came a second time in one tick.
        misfits: number of frames with the identifier of a TPDO but another length; they are not taken.
        invalid: of every drive, why its newest report was not believed, or that somebody else spoke in its name; None
            where all was well.
        counter: of the newest SYNC.
        positions_mask, all_mask: what to ask `has` for: what brings the load encoders, or every TPDO.
    """

    def __init__(
        self,
        scales: Sequence[AxisScale],
        node_ids: Sequence[int],
        period: float,
        channels: Sequence[int] | None = None,
        protected: bool = False,
    ) -> None:
        count = len(scales)
        self.statuswords: list[int | None] = [None] * count
        self.duplicates = self.misfits = self.counter = 0
        self.invalid: list[Invalid | None] = [None] * count
        self._load_unit = tuple([scale.load_encoder for scale in scales])
        self._motor_unit = tuple([scale.motor_encoder for scale in scales])
        self._effort_unit = tuple([scale.effort for scale in scales])
        self._velocity_unit = tuple([scale.velocity for scale in scales])
        self._period, self._node_ids = period, tuple(node_ids)
        bases = (*TPDO_BASES, CHECK_BASE) if protected else TPDO_BASES
        self._slots = {
            base + n: (i, 1 << i + pdo * count, pdo, _LENGTHS[pdo], None if channels is None else channels[i])
            for pdo, base in enumerate(bases)
            for i, n in enumerate(node_ids)
        }
        self.all_mask = (1 << len(bases) * count) - 1
        self.positions_mask = self.all_mask if protected else (1 << count) - 1
        self._of_axis = [sum(1 << i + pdo * count for pdo in range(len(bases))) for i in range(count)]
        self._protected, self._count = protected, count
        self._mask = 0
        self._said: list[list[bytes]] = [[b""] * len(bases) for _ in scales]
        self._doubt: dict[int, tuple[Reason, str]] = {}
        self._load, self._torque = [0] * count, [0] * count
        self._motor, self._demand = [0] * count, [0] * count
        self._previous: tuple[int, Vector] | None = None
        self._tick = 0
        self._usual_order: list[int] = []
        self._usual_headers: tuple[bytes, ...] = ()
        if protected and channels is not None:
            self._expect(channels)
        self._usual = struct.Struct("8s8s" * len(self._usual_headers))

    def _expect(self, channels: Sequence[int]) -> None:
        """Note the bundle of nearly every tick: all channels in order, and the three frames of each drive in order."""
        pack, bases = struct.Struct(f"<{HEADER_FORMAT}").pack, (*TPDO_BASES, CHECK_BASE)
        self._usual_order = sorted(range(self._count), key=channels.__getitem__)
        self._usual_headers = tuple(
            [
                pack(base + self._node_ids[i], size, channels[i])
                for i in self._usual_order
                for base, size in zip(bases, _LENGTHS, strict=True)
            ]
        )

    def forget(self) -> None:
        """Forget the statuswords: the drives restarted."""
        self.statuswords[:] = [None] * self._count

    def begin(self, counter: int = 0) -> None:
        """Start a tick, whose SYNC has this counter."""
        self._doubt.clear()
        self._mask, self.counter = 0, counter
        self._tick += 1

    def end(self) -> bool:
        """End a tick: count it, for every drive, as one to be doubted or as a good one; return whether one was not."""
        if not self.has(self.all_mask):
            self._doubt_silent()
        for axis, before in enumerate(self.invalid):
            doubt = self._doubt.get(axis)
            if doubt is not None:
                self.invalid[axis] = Invalid(*doubt, 1 if before is None else before.times + 1)
            elif before is not None and not self._of_axis[axis] & ~self._mask:
                self.invalid[axis] = None
        return any(self.invalid)

    def _doubt_silent(self) -> None:
        """Doubt drives that were heard before and stay away while others come: then this computer is not late."""
        missing = self.missing()
        for axis in missing if len(missing) < self._count else ():
            if self.statuswords[axis] is not None:
                self._doubt.setdefault(axis, (Reason.DRIVE_SILENT, "no TPDO while other drives are heard"))

    def take(self, frames: bytes) -> list[tuple[int, int, bytes]]:
        """Take the frames of a bundle; return (channel, can_id, data) of those that are no TPDO of their channel.

        Raises:
            FrameError: the bundle is no whole number of frames.
        """
        if len(frames) % FRAME_SIZE:
            check_frames(frames)
        if frames and len(frames) == self._usual.size and not self._mask and self._take_usual(frames):
            return []
        others = []
        slots = self._slots
        for can_id, length, channel, data in BUNDLED.iter_unpack(frames):
            slot = slots.get(can_id)
            if slot is None or slot[4] not in (None, channel):
                others.append((channel, can_id, data[:length]))
                continue
            axis, bit, pdo, right_length, _ = slot
            if length != right_length:
                self.misfits += 1
                continue
            if self._mask & bit:
                self.duplicates += 1
                if data != self._said[axis][pdo]:
                    self._doubt[axis] = Reason.DRIVE_TWICE, "two reports in one tick contradict each other"
            self._said[axis][pdo] = data
            self._mask |= bit
            if not self._protected:
                self._read(axis, pdo)
            elif not self._of_axis[axis] & ~self._mask:
                self._judge(axis)
        return others

    def _take_usual(self, frames: bytes) -> bool:
        """Take the bundle of nearly every tick; False where it is another one, of which nothing is taken."""
        fields = self._usual.unpack(frames)
        if fields[0::2] != self._usual_headers:
            return False
        said = fields[1::2]
        self._mask = self.all_mask
        for place, axis in enumerate(self._usual_order):
            self._said[axis][:] = said[3 * place : 3 * place + 3]
            self._judge(axis)
        return True

    def _read(self, axis: int, pdo: int) -> None:
        data = self._said[axis][pdo]
        if pdo:
            self._motor[axis], self._demand[axis] = TPDO2_DATA.unpack(data)
        else:
            self._load[axis], self.statuswords[axis], self._torque[axis] = TPDO1_DATA.unpack(data)

    def _judge(self, axis: int) -> None:
        """Believe the reports of a drive when their check is that of its node id and this SYNC; else drop them."""
        first, second, last = self._said[axis]
        data, (check,) = first + second, CHECK_DATA.unpack_from(last)
        if check == check_of(data, self._node_ids[axis], self.counter):
            load, word, torque, motor, demand = _REPORT.unpack(data)
            self._load[axis], self.statuswords[axis], self._torque[axis] = load, word, torque
            self._motor[axis], self._demand[axis] = motor, demand
            if axis in self._doubt and self._doubt[axis][0] is not Reason.DRIVE_TWICE:
                del self._doubt[axis]
            return
        self._mask &= ~self._of_axis[axis]
        self._doubt.setdefault(axis, self._doubt_of(axis, data, check))

    def _doubt_of(self, axis: int, data: bytes, check: int) -> tuple[Reason, str]:
        """Return what is wrong with reports whose check is not that of this drive and SYNC."""
        own = self._node_ids[axis]
        for age in range(1, OLDEST_REPORT + 1):
            if check == check_of(data, own, count_before(self.counter, age)):
                return Reason.FEEDBACK_STALE, f"its report is {age} ticks old"
        for node in self._node_ids:
            if check == check_of(data, node, self.counter):
                return Reason.FEEDBACK_SWAPPED, f"its report is that of node {node}"
        return Reason.FEEDBACK_GARBLED, "its report fails its check"

    def has(self, mask: int) -> bool:
        """Whether every TPDO of `mask` is in."""
        return self._mask & mask == mask

    def missing(self) -> list[int]:
        """Return the indices of drives with a TPDO missing."""
        return [axis for axis, mask in enumerate(self._of_axis) if mask & ~self._mask]

    def load_position(self) -> Vector:
        """Return the load encoder positions (5,), m or rad."""
        return tuple(map(mul, self._load, self._load_unit))

    def feedback(self, stamp: int) -> DriveFeedback:
        """Return the whole feedback of the tick `stamp` (ns); call it once a tick and only when every TPDO is in."""
        seen = self.newest(stamp)
        motor, previous = seen.motor_position, self._previous
        self._previous = self._tick, motor
        if previous is None:
            return seen
        tick, before = previous
        span = (self._tick - tick) * self._period
        return seen._replace(motor_velocity=tuple([step / span for step in map(sub, motor, before)]))

    def newest(self, stamp: int) -> DriveFeedback:
        """Return the newest report of every drive at the tick `stamp` (ns), of this tick or an older one.

        Velocities, which take two reports, are zero.
        """
        motor = tuple(map(mul, self._motor, self._motor_unit))
        effort = tuple(map(mul, self._torque, self._effort_unit))
        demand = tuple(map(mul, self._demand, self._velocity_unit))
        return DriveFeedback(stamp, self.load_position(), motor, (0.0,) * self._count, effort, demand)
