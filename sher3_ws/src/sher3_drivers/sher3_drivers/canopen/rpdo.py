"""The RPDOs of a tick: controlword and target velocity of every drive, packed in one call."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from operator import itemgetter

from sher3_drivers.bus.frame import HEADER_FORMAT
from sher3_drivers.bus.load import RPDO_BYTES
from sher3_drivers.canopen.cia402 import Controlword
from sher3_drivers.canopen.objects import RPDO_BASE


class RpdoPacker:
    """Packs RPDO1 of every drive (`objects.RPDO1`).

    Args:
        channels: indices of the drives on every channel; together every drive once.
        node_ids: CANopen node ids of all drives.
    """

    def __init__(self, channels: Sequence[Sequence[int]], node_ids: Sequence[int]) -> None:
        placed = [(channel, axis) for channel, axes in enumerate(channels) for axis in axes]
        header = struct.Struct(f"<{HEADER_FORMAT}")
        self._headers = [header.pack(RPDO_BASE + node_ids[axis], RPDO_BYTES, channel) for channel, axis in placed]
        self._in_order = itemgetter(*[axis for _, axis in placed])
        self._pack = struct.Struct("<" + "8sHi2x" * len(placed)).pack

    def frames(self, commands: Sequence[Controlword], velocity_counts: Sequence[int]) -> bytes:
        """Return the frames of all channels as one bundle.

        Args:
            commands: controlword of every drive (5,).
            velocity_counts: target velocity of every drive (5,), in counts.
        """
        fields: list[bytes | int] = [b""] * (3 * len(self._headers))
        fields[0::3] = self._headers
        fields[1::3] = [command.value for command in self._in_order(commands)]
        fields[2::3] = self._in_order(velocity_counts)
        return self._pack(*fields)
