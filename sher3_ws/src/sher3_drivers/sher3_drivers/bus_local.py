"""The local link: a CAN bus between processes of one user on one machine, without a kernel module.

A *cable* carries one or several channels: `local:drives/0`, `local:drives/1` are channels 0 and 1 of the cable
`drives`, `local:drives` is its channel 0. Links of a cable that are opened together share one socket, so that a tick
of all channels is one datagram: waking a process costs more than sixteen frames do.

Every participant owns one AF_UNIX datagram socket in a private directory, `<runtime>/sher3/can/<cable>/`; a datagram
holds any number of 16-byte frames, each marked with its channel (`frame.bundle`). AF_UNIX has no address outside the
machine, and the directory (mode 0700) keeps other users out. Who joins greets those who are there; a socket whose
owner is gone refuses the connection and is removed by the first who notices.

A reader that lags behind fills its queue (the kernel holds `net.unix.max_dgram_qlen`, often 10, datagrams). Senders
never block on it: they keep what it could not take, up to a bound, and bundle it into the next datagram; beyond the
bound frames are dropped and counted.
"""

from __future__ import annotations

import contextlib
import os
import re
import secrets
import socket
import stat
import tempfile
from collections import Counter
from pathlib import Path

from .errors import LinkError
from .frame import FRAME_SIZE, bundle, channels_of, check_frames, mark, unbundle

_GREETING = b"sher3+"
"""Starts a greeting; the rest is the socket's file name. No frame starts so: error and remote flag together."""


def runtime_directory() -> Path:
    """Return this user's private runtime directory, made when it is missing.

    Raises:
        LinkError: the directory belongs to somebody else or others may enter it.
    """
    base = os.environ.get("XDG_RUNTIME_DIR")
    path = Path(base) / "sher3" if base else Path(tempfile.gettempdir()) / f"sher3-{os.getuid()}"
    path.mkdir(mode=0o700, parents=True, exist_ok=True)
    status = path.lstat()
    if not stat.S_ISDIR(status.st_mode) or status.st_uid != os.getuid() or status.st_mode & 0o077:
        mode = f"owner {status.st_uid}, mode {stat.S_IMODE(status.st_mode):o}"
        raise LinkError(
            "the runtime directory is not private",
            link=str(path),
            value=mode,
            limit=f"owner {os.getuid()}, mode 700",
            remedy="remove it",
        )
    return path


class _Peer:
    """The sending end towards one participant: a connected socket and what it could not take yet."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.backlog = b""
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
        self.socket.connect(str(path))


class LocalCable:
    """A participant of all channels of the cable `name`.

    Attributes:
        links: the channels that are open, by number.
        dropped: frames that could not be delivered, by channel.
    """

    BACKLOG = 4096
    """Frames kept for a participant that lags, before further ones are dropped."""

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
                peer.socket.settimeout(1.0)
                try:
                    peer.socket.send(_GREETING + self._path.name.encode())
                except TimeoutError:
                    self.close()
                    raise LinkError(
                        "a participant does not read its frames",
                        link=self.name,
                        value=path.name,
                        limit="1 s",
                        remedy="end that process",
                    ) from None
                except ConnectionError:
                    self._forget(peer)
                    continue
                peer.socket.setblocking(False)

    def _meet(self, name: str) -> bool:
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
        room = max(0, self.BACKLOG * FRAME_SIZE - len(peer.backlog))
        peer.backlog += datagram[:room]
        self.dropped.update(channels_of(datagram[room:]))

    def _forget(self, peer: _Peer, unlink: bool = True) -> None:
        peer.socket.close()
        self._peers.pop(peer.path.name, None)
        if unlink:
            peer.path.unlink(missing_ok=True)

    def receive(self) -> bytes:
        """Return the bundle that came next; b"" when none waits."""
        return self._next() if not self._sorted else self._unsorted()

    def _next(self) -> bytes:
        try:
            while True:
                datagram = self._socket.recv(65536)
                if datagram.startswith(_GREETING):
                    self._meet(datagram[len(_GREETING) :].decode("ascii", "replace").replace("/", "_"))
                elif datagram and len(datagram) % FRAME_SIZE == 0:
                    return datagram
        except BlockingIOError:
            return b""
        except OSError as error:
            raise LinkError(f"cannot receive: {error}", link=self.name, remedy="open it again") from error

    def sort(self) -> bool:
        """Give the frames of the next bundle to the links of their channels; False when none waits.

        Frames of channels that are not open here are for others.
        """
        frames = self._next()
        for channel, part in enumerate(unbundle(frames, max(self.links) + 1)):
            if part and channel in self.links:
                self.links[channel].inbox += part
                self._sorted = True
        return bool(frames)

    def _unsorted(self) -> bytes:
        """Return the bundle of what has been sorted and not been asked for, or else the next one."""
        self._sorted = False
        parts = [bytes(self.links[i].inbox) if i in self.links else b"" for i in range(max(self.links) + 1)]
        for link in self.links.values():
            link.inbox.clear()
        return bundle(parts) or self._next()

    def fileno(self) -> int:
        """Return the receiving socket's descriptor."""
        return self._socket.fileno()

    def close(self) -> None:
        """Leave the cable, with a last attempt to deliver what is kept back, and remove the socket."""
        with contextlib.suppress(OSError):
            for peer in tuple(self._peers.values()):
                if peer.backlog:
                    peer.socket.send(peer.backlog)
        for peer in tuple(self._peers.values()):
            self._forget(peer, unlink=False)
        self._socket.close()
        self._path.unlink(missing_ok=True)


class LocalLink:
    """A participant of one channel, `<cable>` or `<cable>/<number>`; see `bus.CanLink`.

    Args:
        channel: the channel.
        cable: the cable, shared with links of its other channels; otherwise the link opens its own.

    Attributes:
        name: its specification.
        cable: the cable.
        number: number of the channel on it.
        inbox: frames that came in together with those of other channels.
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
        """Frames of this channel that could not be delivered."""
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
    """Return cable and number of `<cable>` or `<cable>/<number>`; raise LinkError when that is no number to 255."""
    name, separator, number = channel.partition("/")
    if separator and not (number.isdecimal() and number.isascii() and int(number) <= 255):
        raise LinkError("the channel number is none", link=f"local:{channel}", value=number, limit="0 to 255")
    return name, int(number or 0)
