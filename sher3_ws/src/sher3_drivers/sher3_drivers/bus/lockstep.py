"""A link for stepped time: both ends of the bus run in one thread, so that a test sees the same order every time."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from sher3_drivers.bus.link import CanLink


class LockstepLink:
    """A link that runs the other end of the bus before it looks for frames: one thread drives both ends.

    Args:
        link: the link of this end.
        other_side: functions that serve the other end, called before every reading.
    """

    def __init__(self, link: CanLink, other_side: Sequence[Callable[[], object]] = ()) -> None:
        self._link = link
        self._other_side = other_side
        self.name = link.name

    @property
    def dropped(self) -> int:
        """Number of frames that could not be delivered."""
        return self._link.dropped

    def send_frames(self, frames: bytes) -> None:
        """Send whole frames in order."""
        self._link.send_frames(frames)

    def recv_frames(self) -> bytes:
        """Let the other side run, then return the frames that wait."""
        for poll in self._other_side:
            poll()
        return self._link.recv_frames()

    def fileno(self) -> int:
        """Return -1: there is nothing to wait on, since the other side runs in this thread."""
        return -1

    def close(self) -> None:
        """Leave the bus."""
        self._link.close()
