"""The RPDOs of a tick: controlword and target velocity of every drive, packed in one call."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from operator import itemgetter

from sher3_drivers.bus.frame import HEADER_FORMAT
from sher3_drivers.bus.load import CHECK_BYTES, RPDO_BYTES
from sher3_drivers.canopen.cia402 import Controlword
from sher3_drivers.canopen.objects import RPDO_BASE
from sher3_drivers.canopen.protection import check_of

RPDO_DATA = struct.Struct("<Hi")
"""Controlword, target velocity: the mapping of `objects.RPDO1`."""


class RpdoPacker:
    """Packs RPDO1 of every drive (`objects.RPDO1`, with protection `objects.CHECKED_RPDO1`).

    Args:
        channels: indices of the drives on every channel; together every drive once.
        node_ids: CANopen node ids of all drives.
        protected: with a check behind every command.
    """

    def __init__(self, channels: Sequence[Sequence[int]], node_ids: Sequence[int], protected: bool = False) -> None:
        placed = [(channel, axis) for channel, axes in enumerate(channels) for axis in axes]
        header, length = struct.Struct(f"<{HEADER_FORMAT}"), RPDO_BYTES + CHECK_BYTES * protected
        self._headers = [header.pack(RPDO_BASE + node_ids[axis], length, channel) for channel, axis in placed]
        self._in_order = itemgetter(*[axis for _, axis in placed])
        self._nodes = [node_ids[axis] for _, axis in placed]
        self._protected = protected
        self._pack = struct.Struct("<" + "8sHiH" * len(placed)).pack

    def frames(self, commands: Sequence[Controlword], velocity_counts: Sequence[int], counter: int = 0) -> bytes:
        """Return the frames of all channels as one bundle.

        Args:
            commands: controlword of every drive (5,).
            velocity_counts: target velocity of every drive (5,), in counts.
            counter: of the newest SYNC.
        """
        words, velocities = self._in_order(commands), self._in_order(velocity_counts)
        fields: list[bytes | int] = [b""] * (4 * len(self._headers))
        fields[0::4] = self._headers
        fields[1::4] = words
        fields[2::4] = velocities
        fields[3::4] = self._checks(words, velocities, counter) if self._protected else [0] * len(words)
        return self._pack(*fields)

    def _checks(self, words: Sequence[int], velocities: Sequence[int], counter: int) -> list[int]:
        pack = RPDO_DATA.pack
        commands = zip(words, velocities, self._nodes, strict=True)
        return [check_of(pack(word, velocity), node, counter) for word, velocity, node in commands]
