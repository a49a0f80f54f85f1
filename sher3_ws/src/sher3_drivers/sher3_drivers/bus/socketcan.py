"""The hardware link: raw frames through the socket of python-can's socketcan bus, error frames included."""

from __future__ import annotations

import errno
import socket

from sher3_drivers.bus.frame import FRAME_SIZE, check_frames
from sher3_drivers.errors import LinkError

_BATCH = 4096
"""Frames read in one call at most, so that a flooded bus cannot hold the caller: half a second of a full bus."""


class SocketCanLink:
    """A participant of the CAN interface `channel`; see `bus.link.CanLink`.

    Raises:
        LinkError: the interface does not exist or is down.
    """

    def __init__(self, channel: str) -> None:
        self.name = f"socketcan:{channel}"
        self.dropped = 0
        import can  # only who has the hardware waits for it

        try:
            self._bus = can.Bus(interface="socketcan", channel=channel)
        except (OSError, can.CanError) as error:
            remedy = (
                f"bring it up: ip link set {channel} up type can bitrate 1000000; without hardware use local:{channel}"
            )
            raise LinkError(f"cannot open the interface: {error}", link=self.name, remedy=remedy) from error
        self._socket: socket.socket = self._bus.socket  # type: ignore[attr-defined]
        self._socket.setblocking(False)

    def send_frames(self, frames: bytes) -> None:
        """Send the frames one by one, since the kernel takes one per call.

        Raises:
            LinkError: the transmit queue is full (bus off, unplugged or overloaded), or the interface is down. The
                frames that were left are dropped and counted.
        """
        check_frames(frames)
        for start in range(0, len(frames), FRAME_SIZE):
            try:
                self._socket.send(frames[start : start + FRAME_SIZE])
            except OSError as error:
                self.dropped += (len(frames) - start) // FRAME_SIZE
                full = error.errno in (errno.ENOBUFS, errno.EAGAIN)
                what = (
                    "the transmit queue is full: no other node acknowledges, or the bus is off"
                    if full
                    else f"cannot send: {error}"
                )
                raise LinkError(
                    what, link=self.name, value=self.dropped, remedy="check cable, termination and bit rate"
                ) from error

    def recv_frames(self) -> bytes:
        """Return the frames that wait, at most `_BATCH`; the kernel gives one per call.

        Raises:
            LinkError: the interface is down.
        """
        parts: list[bytes] = []
        try:
            while len(parts) < _BATCH:
                parts.append(self._socket.recv(FRAME_SIZE))
        except BlockingIOError:
            pass
        except OSError as error:
            raise LinkError(
                f"cannot receive: {error}", link=self.name, remedy="bring the interface up and open it again"
            ) from error
        return b"".join(parts)

    def fileno(self) -> int:
        """Return the socket's descriptor."""
        return self._socket.fileno()

    def close(self) -> None:
        """Close the bus."""
        self._bus.shutdown()
