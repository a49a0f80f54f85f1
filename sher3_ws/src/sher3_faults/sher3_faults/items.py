"""What the items of each faulty stream are: CAN frames, force records, pedal states, single numbers."""

from __future__ import annotations

import math
import struct
from collections.abc import Hashable, Sequence
from random import Random
from typing import Any

from sher3_drivers.bus.frame import ERROR_FLAG
from sher3_drivers.pedal.device import PedalState, wired
from sher3_drivers.sensor.device import WrenchRecord

from sher3_faults.kinds import Parameters

_FRAME = struct.Struct("<IB3x8s")
_NOISE = (3e-3,) * 3 + (3e-5,) * 3
_ERROR_PASSIVE = _FRAME.pack(ERROR_FLAG | 0x004, 8, bytes([0, 0x30, 0, 0, 0, 0, 0, 0]))
"""Error frame of class "controller" with "error passive" (include/uapi/linux/can/error.h)."""


class BusFrames:
    """Frames of a whole bus, 16 bytes each. Wrong: damaged on the line, an error frame comes in its place."""

    def key(self, item: bytes) -> Hashable:
        """Return the CAN identifier, the source of a frame."""
        return item[:4]

    def garbage(self, item: bytes, random: Random) -> bytes:
        """Return random data under the same identifier and length."""
        return item[:8] + random.randbytes(8)

    def exchanged(self, item: bytes) -> bytes:
        """Return a frame of node 1 as one of node 2, and the other way round; other frames stay."""
        can_id, length, data = _FRAME.unpack(item)
        return _FRAME.pack(can_id ^ 3, length, data) if can_id & 0x7F in (1, 2) else item

    def alive(self, item: bytes, random: Random) -> bytes:
        """Return the frame: a bus has no noise."""
        return item

    def wrong(self, item: bytes, parameters: Parameters) -> bytes:
        """Return an error frame, "error passive"."""
        return _ERROR_PASSIVE


class DriveFrames(BusFrames):
    """Frames of one drive. Wrong: they bear the node id of the next one, as after a wrong COB-ID."""

    def wrong(self, item: bytes, parameters: Parameters) -> bytes:
        """Return the frame with the node id of the next drive."""
        can_id, length, data = _FRAME.unpack(item)
        return _FRAME.pack(can_id + 1, length, data)


class OneSource:
    """Items that all come from one source."""

    def key(self, item: Any) -> Hashable:
        """Return the one source."""
        return None

    def exchanged(self, item: Any) -> Any:
        """Return the item: there is no other source."""
        return item

    def alive(self, item: Any, random: Random) -> Any:
        """Return the item: it has no noise."""
        return item


class WrenchRecords(OneSource):
    """Records of the force sensor.

    Wrong: turned about y by `angle`, scaled, offset along every axis of force [N], with a `force` along z and a
    `torque` about x of its own, and a status word `code`.
    """

    def garbage(self, item: WrenchRecord, random: Random) -> WrenchRecord:
        """Draw each component from the whole range of 32 bit counts: up to 2147 N and 2.1 N m."""
        wrench = tuple([random.uniform(-2147.0, 2147.0) * scale for scale in (1, 1, 1, 1e-3, 1e-3, 1e-3)])
        return item._replace(wrench=wrench)  # type: ignore[arg-type]

    def alive(self, item: WrenchRecord, random: Random) -> WrenchRecord:
        """Add the noise of a sensor that works: 3 mN and 0.03 mN m."""
        noisy = tuple([random.gauss(value, size) for value, size in zip(item.wrench, _NOISE, strict=True)])
        return item._replace(wrench=noisy)  # type: ignore[arg-type]

    def wrong(self, item: WrenchRecord, parameters: Parameters) -> WrenchRecord:
        """Turn, scale, then add the offset to the force."""
        scale, offset, angle = parameters["scale"], parameters["offset"], parameters.get("angle", 0.0)
        force, torque = parameters.get("force", 0.0), parameters.get("torque", 0.0)
        c, s = math.cos(angle), math.sin(angle)
        fx, fy, fz, mx, my, mz = (scale * value for value in item.wrench)
        fx, fz, mx, mz = c * fx + s * fz, c * fz - s * fx, c * mx + s * mz, c * mz - s * mx
        wrench = (fx + offset, fy + offset, fz + offset + force, mx + torque, my, mz)
        return item._replace(wrench=wrench, status=int(parameters["code"]))


class PedalStates(OneSource):
    """States of the pedal. Wrong: the travel is scaled and offset, and with `code` 1 both contacts go with it."""

    def garbage(self, item: PedalState, random: Random) -> PedalState:
        """Draw a travel, also outside 0 to 1."""
        travel = random.choice([random.uniform(-2.0, 2.0), math.nan, math.inf, 1e300])
        return wired(PedalState(travel, False))

    def wrong(self, item: PedalState, parameters: Parameters) -> PedalState:
        """Return the travel scaled, then offset."""
        false = item._replace(travel=parameters["scale"] * item.travel + parameters["offset"])
        return wired(false._replace(made=None, rest=None)) if parameters["code"] else false


class Stamps(OneSource):
    """Stamps of the ticks of one node [ns]: its clock. Wrong: offset [s]; garbage: up to a tenth of a second off."""

    def garbage(self, item: int, random: Random) -> int:
        """Draw a stamp evenly around the true one."""
        return item + random.randint(-100_000_000, 100_000_000)

    def wrong(self, item: int, parameters: Parameters) -> int:
        """Return the stamp with the offset added."""
        return item + round(parameters["offset"] * 1e9)


class Numbers(OneSource):
    """One number per tick: an encoder [m, rad] or a velocity demand [counts].

    Args:
        spread: garbage is drawn from plus and minus this.
    """

    def __init__(self, spread: float) -> None:
        self._spread = spread

    def garbage(self, item: float, random: Random) -> float:
        """Draw a number evenly between plus and minus `spread`."""
        return random.uniform(-self._spread, self._spread)

    def wrong(self, item: float, parameters: Parameters) -> float:
        """Return the value scaled, then offset."""
        return parameters["scale"] * item + parameters["offset"]


class Columns(OneSource):
    """One number of each axis at a time, as the plugs of its cabinet are wired."""

    def garbage(self, item: Sequence[float], random: Random) -> Sequence[float]:
        """Return the item: cables draw nothing."""
        return item

    def wrong(self, item: Sequence[float], parameters: Parameters) -> Sequence[float]:
        """Exchange the numbers of two axes, or turn the sign of one."""
        one, other = int(parameters["one"]) - 1, int(parameters["other"]) - 1
        crossed = list(item)
        crossed[one], crossed[other] = item[other], item[one] if one != other else -item[one]
        return crossed
