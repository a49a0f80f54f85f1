"""The hardware link: raw frames through the socket of python-can's socketcan bus, error frames included."""

from __future__ import annotations

import errno
import socket

import can

from .errors import LinkError
from .frame import FRAME_SIZE, check_frames


class SocketCanLink:
    """A participant of the CAN interface `channel`; see `bus.CanLink`."""

    def __init__(self, channel: str) -> None:
        self.name = f"socketcan:{channel}"
        self.dropped = 0
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
        """Write the frames one by one (the kernel takes one per call).

        Raises:
            LinkError: the transmit queue is full (bus off, unplugged or overloaded) or the interface is down.
                The rest is not sent later.
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
        """Read frame by frame until none is left."""
        parts: list[bytes] = []
        try:
            while len(parts) < 4096:
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
