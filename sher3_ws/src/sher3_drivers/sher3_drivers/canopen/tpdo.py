"""The TPDOs of one tick: frames in, one feedback in SI units out when all are there, and the missing ones by name."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from operator import mul, sub
from typing import NamedTuple

from sher3_common.vectors import Vector

from sher3_drivers.bus.frame import BUNDLED, FRAME_SIZE, check_frames
from sher3_drivers.canopen.objects import TPDO_BASES
from sher3_drivers.units import AxisScale

_LENGTH = 8
"""Bytes of either TPDO (`bus.load.TPDO_BYTES`)."""
TPDO1_DATA = struct.Struct("<iHh")
"""Load encoder, statusword, torque: the mapping of `objects.TPDO1`."""
TPDO2_DATA = struct.Struct("<ii")
"""Motor encoder, velocity demand: the mapping of `objects.TPDO2`."""


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


class TpdoCollector:
    """Sorts the frames of a tick by drive and PDO.

    Args:
        scales: scales of the five axes.
        node_ids: CANopen node ids of the five drives, in the same order.
        period: control period, s.

    Attributes:
        statuswords: newest statusword of every drive, None before the first.
        duplicates: number of TPDOs that came a second time in one tick; they are not taken.
        misfits: number of frames with the identifier of a TPDO but another length; they are not taken.
        positions_mask, all_mask: what to ask `has` for: every TPDO1, which brings the load encoders, or every TPDO.
    """

    def __init__(self, scales: Sequence[AxisScale], node_ids: Sequence[int], period: float) -> None:
        count = len(scales)
        self.statuswords: list[int | None] = [None] * count
        self.duplicates = 0
        self.misfits = 0
        self._load_unit = tuple([scale.load_encoder for scale in scales])
        self._motor_unit = tuple([scale.motor_encoder for scale in scales])
        self._effort_unit = tuple([scale.effort for scale in scales])
        self._velocity_unit = tuple([scale.velocity for scale in scales])
        self._period = period
        self._slots = {
            base + n: (i, 1 << i + pdo * count, pdo)
            for pdo, base in enumerate(TPDO_BASES)
            for i, n in enumerate(node_ids)
        }
        self.positions_mask = (1 << count) - 1
        self.all_mask = (1 << 2 * count) - 1
        self._count = count
        self._mask = 0
        self._load, self._torque = [0] * count, [0] * count
        self._motor, self._demand = [0] * count, [0] * count
        self._previous: tuple[int, Vector] | None = None
        self._tick = 0

    def forget(self) -> None:
        """Forget the statuswords: the drives restarted."""
        self.statuswords[:] = [None] * self._count

    def begin(self) -> None:
        """Start a tick."""
        self._mask = 0
        self._tick += 1

    def take(self, frames: bytes) -> list[tuple[int, int, bytes]]:
        """Take the frames of a bundle; return (channel, can_id, data) of those that are no TPDO.

        Raises:
            FrameError: the bundle is no whole number of frames.
        """
        if len(frames) % FRAME_SIZE:
            check_frames(frames)
        others = []
        slots = self._slots
        for can_id, length, channel, data in BUNDLED.iter_unpack(frames):
            slot = slots.get(can_id)
            if slot is None:
                others.append((channel, can_id, data[:length]))
                continue
            axis, bit, second = slot
            if length != _LENGTH:
                self.misfits += 1
            elif self._mask & bit:
                self.duplicates += 1
            else:
                self._mask |= bit
                if second:
                    self._motor[axis], self._demand[axis] = TPDO2_DATA.unpack(data)
                else:
                    self._load[axis], self.statuswords[axis], self._torque[axis] = TPDO1_DATA.unpack(data)
        return others

    def has(self, mask: int) -> bool:
        """Whether every TPDO of `mask` is in."""
        return self._mask & mask == mask

    def missing(self) -> list[int]:
        """Return the indices of drives with a TPDO missing."""
        both = self._mask & self._mask >> self._count
        return [i for i in range(self._count) if not both >> i & 1]

    def load_position(self) -> Vector:
        """Return the load encoder positions (5,), m or rad."""
        return tuple(map(mul, self._load, self._load_unit))

    def feedback(self, stamp: int) -> DriveFeedback:
        """Return the whole feedback of the tick `stamp` (ns); call it once a tick and only when every TPDO is in."""
        motor = tuple(map(mul, self._motor, self._motor_unit))
        if self._previous is None:
            velocity: Vector = (0.0,) * self._count
        else:
            tick, before = self._previous
            span = (self._tick - tick) * self._period
            velocity = tuple([step / span for step in map(sub, motor, before)])
        self._previous = self._tick, motor
        effort = tuple(map(mul, self._torque, self._effort_unit))
        demand = tuple(map(mul, self._demand, self._velocity_unit))
        return DriveFeedback(stamp, self.load_position(), motor, velocity, effort, demand)
