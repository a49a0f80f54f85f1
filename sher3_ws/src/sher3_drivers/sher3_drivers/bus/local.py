"""The local link: a CAN bus between processes of one user on one machine, without a kernel module.

A *cable* carries one or several channels: `local:drives/0`, `local:drives/1` are channels 0 and 1 of the cable
`drives`, `local:drives` is its channel 0. Links of a cable that are opened together share one socket, so that a tick
of all channels is one datagram: waking a process costs more than sixteen frames do.

Every participant owns one AF_UNIX datagram socket in a private directory, `<runtime>/sher3/can/<cable>/`; a datagram
holds any number of 16-byte frames, each marked with its channel (`frame.bundle`). AF_UNIX has no address outside the
machine, and the directory (mode 0700) keeps other users out. A participant that joins greets those that are there. A
socket whose owner is gone refuses the connection; the first participant that notices removes it.

A reader that lags behind fills its queue: the kernel holds `net.unix.max_dgram_qlen` datagrams, often 10. Senders do
not block on it. They keep the frames it could not take, up to a bound, and put them before the next ones; beyond the
bound, frames are dropped and counted.
"""

from __future__ import annotations

import contextlib
import os
import re
import secrets
import socket
from collections import Counter
from pathlib import Path

from sher3_drivers.bus.frame import FRAME_SIZE, bundle, channels_of, check_frames, mark, unbundle
from sher3_drivers.errors import LinkError
from sher3_drivers.runtime_directory import runtime_directory

_GREETING = b"sher3+"
"""A greeting starts with it; the rest is the file name of the sender's socket.

No frame starts so: its fourth byte would set the error flag and the remote flag together.
"""
_GREETING_WAIT = 1.0
"""Longest wait for a participant that does not read, s."""
_MOST_BYTES = 65536
"""Longest datagram taken in: as many frames as `LocalCable.BACKLOG`."""


class _Peer:
    """The sending end towards one participant: a connected socket, and the frames it could not take yet."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.backlog = b""
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
        self.socket.connect(str(path))


class LocalCable:
    """A participant of all channels of a cable.

    Args:
        name: name of the cable: 1 to 32 letters, digits, `_` or `-`.

    Attributes:
        name: its specification.
        links: the channels that are open, by number.
        dropped: number of frames that could not be delivered, by channel.

    Raises:
        LinkError: the name is not plain, or a participant does not read.
    """

    BACKLOG = 4096
    """Frames kept for a participant that lags: 0.25 s of the whole robot at 1 kHz. Further ones are dropped."""

    def __init__(self, name: str) -> None:
        self.name = f"local:{name}"
        self.links: dict[int, LocalLink] = {}
        self.dropped: Counter[int] = Counter()
        if not re.fullmatch(r"[A-Za-z0-9_-]{1,32}", name):
            raise LinkError(
                "the channel name is not plain", link=self.name, limit="1-32 of A-Z a-z 0-9 _ -", remedy="rename it"
            )
        self._directory = runtime_directory() / "can" / name
        self._directory.mkdir(mode=0o700, parents=True, exist_ok=True)
        self._path = self._directory / f"{os.getpid()}-{secrets.token_hex(4)}"
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
        self._bind()
        self._peers: dict[str, _Peer] = {}
        self._sorted = False
        self._greet()

    def _bind(self) -> None:
        try:
            self._socket.bind(str(self._path))
        except OSError as error:
            self._socket.close()
            raise LinkError(
                f"cannot bind {self._path}: {error}", link=self.name, remedy="use a shorter runtime directory"
            ) from error

    def _greet(self) -> None:
        """Meet every participant that is there and tell it the way back, waiting up to a second for a busy one."""
        for path in tuple(self._directory.iterdir()):
            if path != self._path and self._meet(path.name):
                peer = self._peers[path.name]
                peer.socket.settimeout(_GREETING_WAIT)
                try:
                    peer.socket.send(_GREETING + self._path.name.encode())
                except TimeoutError:
                    self.close()
                    raise LinkError(
                        "a participant does not read its frames",
                        link=self.name,
                        value=path.name,
                        limit=f"{_GREETING_WAIT:g} s",
                        remedy="end that process",
                    ) from None
                except ConnectionError:
                    self._forget(peer)
                    continue
                peer.socket.setblocking(False)

    def _meet(self, name: str) -> bool:
        """Connect to the participant with this socket; return False when it is gone."""
        if name in self._peers:
            return True
        path = self._directory / name
        try:
            self._peers[name] = _Peer(path)
        except (ConnectionRefusedError, FileNotFoundError):
            path.unlink(missing_ok=True)
            return False
        return True

    def send(self, frames: bytes) -> None:
        """Send a bundle to every participant, as one datagram each; raise LinkError when the cable is closed."""
        if self._socket.fileno() < 0:
            raise LinkError("is closed", link=self.name, remedy="open it again")
        for peer in tuple(self._peers.values()):
            datagram = frames
            if peer.backlog:
                self._postpone(peer, frames)
                datagram, peer.backlog = peer.backlog, b""
            try:
                peer.socket.send(datagram)
            except BlockingIOError:
                self._postpone(peer, datagram)
            except (ConnectionError, FileNotFoundError):
                self._forget(peer)

    def _postpone(self, peer: _Peer, datagram: bytes) -> None:
        """Keep frames for a participant that lags, as far as there is room."""
        room = max(0, self.BACKLOG * FRAME_SIZE - len(peer.backlog))
        peer.backlog += datagram[:room]
        self.dropped.update(channels_of(datagram[room:]))

    def _forget(self, peer: _Peer, unlink: bool = True) -> None:
        peer.socket.close()
        self._peers.pop(peer.path.name, None)
        if unlink:
            peer.path.unlink(missing_ok=True)

    def receive(self) -> bytes:
        """Return the bundle that came next; b"" when none waits.

        Raises:
            LinkError: the cable is closed.
        """
        return self._next() if not self._sorted else self._unsorted()

    def _next(self) -> bytes:
        try:
            while True:
                datagram = self._socket.recv(_MOST_BYTES)
                if datagram.startswith(_GREETING):
                    self._meet(datagram[len(_GREETING) :].decode("ascii", "replace").replace("/", "_"))
                elif datagram and len(datagram) % FRAME_SIZE == 0:
                    return datagram
        except BlockingIOError:
            return b""
        except OSError as error:
            raise LinkError(f"cannot receive: {error}", link=self.name, remedy="open it again") from error

    def sort(self) -> bool:
        """Give the frames of the next bundle to the links of their channels; return False when none waits.

        Frames of channels that are not open here are left out.
        """
        frames = self._next()
        for channel, part in enumerate(unbundle(frames, max(self.links) + 1)):
            if part and channel in self.links:
                self.links[channel].inbox += part
                self._sorted = True
        return bool(frames)

    def _unsorted(self) -> bytes:
        """Return the frames that were sorted but not asked for, as a bundle; if there are none, the next bundle."""
        self._sorted = False
        parts = [bytes(self.links[i].inbox) if i in self.links else b"" for i in range(max(self.links) + 1)]
        for link in self.links.values():
            link.inbox.clear()
        return bundle(parts) or self._next()

    def fileno(self) -> int:
        """Return the receiving socket's descriptor."""
        return self._socket.fileno()

    def close(self) -> None:
        """Leave the cable and remove the socket, after a last attempt to deliver the frames that were kept."""
        with contextlib.suppress(OSError):
            for peer in tuple(self._peers.values()):
                if peer.backlog:
                    peer.socket.send(peer.backlog)
        for peer in tuple(self._peers.values()):
            self._forget(peer, unlink=False)
        self._socket.close()
        self._path.unlink(missing_ok=True)


class LocalLink:
    """A participant of one channel, `<cable>` or `<cable>/<number>`; see `bus.link.CanLink`.

    Args:
        channel: the channel.
        cable: the cable, shared with links of its other channels; otherwise the link opens its own.

    Attributes:
        name: its specification.
        cable: the cable.
        number: number of the channel on it.
        inbox: frames that came in together with those of other channels.

    Raises:
        LinkError: the channel is not plain, or opened twice on one cable.
    """

    def __init__(self, channel: str, cable: LocalCable | None = None) -> None:
        self.name = f"local:{channel}"
        name, number = split_channel(channel)
        self.cable, self.number, self.inbox = cable or LocalCable(name), number, bytearray()
        if number in self.cable.links:
            raise LinkError("is opened twice on one cable", link=self.name, remedy="give every channel its own number")
        self.cable.links[number] = self

    @property
    def dropped(self) -> int:
        """Number of frames of this channel that could not be delivered."""
        return self.cable.dropped[self.number]

    def send_frames(self, frames: bytes) -> None:
        """Send whole frames to every participant."""
        check_frames(frames)
        self.cable.send(mark(frames, self.number))

    def recv_frames(self) -> bytes:
        """Return the frames that wait."""
        while not self.inbox and self.cable.sort():
            pass
        frames = bytes(self.inbox)
        self.inbox.clear()
        return frames

    def fileno(self) -> int:
        """Return the descriptor of the cable, readable when frames of any of its channels wait."""
        return self.cable.fileno()

    def close(self) -> None:
        """Leave the cable, with all links that share it; closing twice is allowed."""
        self.cable.close()


def split_channel(channel: str) -> tuple[str, int]:
    """Return cable and channel number of `<cable>` or `<cable>/<number>`; without a number it is channel 0.

    Raises:
        LinkError: the number is not one from 0 to 255.
    """
    name, separator, number = channel.partition("/")
    if separator and not (number.isdecimal() and number.isascii() and int(number) <= 255):
        raise LinkError("the channel number is none", link=f"local:{channel}", value=number, limit="0 to 255")
    return name, int(number or 0)
