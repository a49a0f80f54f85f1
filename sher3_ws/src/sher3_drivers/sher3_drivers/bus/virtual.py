"""The link within a process, for stepped tests: every other participant has the frames at once and in order."""

from __future__ import annotations

import weakref

from sher3_drivers.bus.frame import FRAME_SIZE, check_frames
from sher3_drivers.errors import LinkError

_channels: dict[str, list[weakref.ref[VirtualLink]]] = {}


class VirtualLink:
    """A participant of the in-process channel `channel`; see `bus.link.CanLink`. Not for use from several threads."""

    CAPACITY = 4096
    """Frames a participant may leave unread. Further ones are dropped and counted with their sender."""

    def __init__(self, channel: str) -> None:
        self.name = f"virtual:{channel}"
        self.dropped = 0
        self._queue = bytearray()
        self._open = True
        self._members = _channels.setdefault(channel, [])
        self._members[:] = [*(member for member in self._members if member() is not None), weakref.ref(self)]

    def send_frames(self, frames: bytes) -> None:
        """Append whole frames to the queue of every other participant."""
        if not self._open:
            raise LinkError("is closed", link=self.name, remedy="open it again")
        check_frames(frames)
        for reference in self._members:
            member = reference()
            if member is not None and member is not self:
                room = self.CAPACITY * FRAME_SIZE - len(member._queue)
                member._queue += frames[:room]
                self.dropped += max(0, len(frames) - room) // FRAME_SIZE

    def recv_frames(self) -> bytes:
        """Return the frames that wait."""
        if not self._queue:
            return b""
        frames = bytes(self._queue)
        self._queue.clear()
        return frames

    def fileno(self) -> int:
        """Return -1: there is nothing to wait on."""
        return -1

    def close(self) -> None:
        """Leave the channel."""
        self._open = False
        self._queue.clear()
        self._members[:] = [member for member in self._members if member() is not self]
