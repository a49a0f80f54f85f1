"""The RPDOs of a tick: controlword and target velocity of every drive, packed per channel in one call."""

from __future__ import annotations

import struct
from collections.abc import Sequence

from .cia402 import Command
from .drive_objects import RPDO_BASE
from .frame import HEADER_FORMAT

_RPDO = f"{HEADER_FORMAT}Hi2x"
_LENGTH = 6


class RpdoPacker:
    """Frames of RPDO1, see docs/can.md.

    Args:
        channels: per channel the indices of its drives.
        node_ids: CANopen node ids of all drives.
    """

    def __init__(self, channels: Sequence[Sequence[int]], node_ids: Sequence[int]) -> None:
        self._channels = [
            ([(axis, RPDO_BASE + node_ids[axis]) for axis in axes], struct.Struct("<" + _RPDO * len(axes)).pack)
            for axes in channels
        ]

    def frames(self, commands: Sequence[Command], velocity_counts: Sequence[int]) -> list[bytes]:
        """Return the frames of every channel, end to end."""
        parts = []
        for axes, pack in self._channels:
            fields: list[int] = []
            for axis, can_id in axes:
                fields += (can_id, _LENGTH, commands[axis].value, velocity_counts[axis])
            parts.append(pack(*fields))
        return parts
