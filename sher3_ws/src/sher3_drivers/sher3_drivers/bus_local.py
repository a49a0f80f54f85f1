"""The local link: a CAN bus between processes of one user on one machine, without a kernel module.

Every participant owns one AF_UNIX datagram socket in a private directory, `<runtime>/sher3/can/<channel>/`; a
datagram holds any number of 16-byte frames. AF_UNIX has no address outside the machine, and the directory (mode
0700) keeps other users out. Who joins greets those who are there; a socket whose owner is gone refuses the
connection and is removed by the first who notices.

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
import time
from pathlib import Path

from .errors import LinkError
from .frame import FRAME_SIZE, check_frames

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


class LocalLink:
    """A participant of the local channel `channel`; see `bus.CanLink`."""

    BACKLOG = 4096
    """Frames kept for a participant that lags, before further ones are dropped."""

    def __init__(self, channel: str) -> None:
        self.name = f"local:{channel}"
        self.received_at = 0
        self.dropped = 0
        if not re.fullmatch(r"[A-Za-z0-9_-]{1,32}", channel):
            raise LinkError(
                "the channel name is not plain", link=self.name, limit="1-32 of A-Z a-z 0-9 _ -", remedy="rename it"
            )
        self._directory = runtime_directory() / "can" / channel
        self._directory.mkdir(mode=0o700, parents=True, exist_ok=True)
        self._path = self._directory / f"{os.getpid()}-{secrets.token_hex(4)}"
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
        self._bind()
        self._peers: dict[str, _Peer] = {}
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

    def send_frames(self, frames: bytes) -> None:
        """Send whole frames to every participant as one datagram each."""
        if len(frames) % FRAME_SIZE:
            check_frames(frames)
        if self._socket.fileno() < 0:
            raise LinkError("is closed", link=self.name, remedy="open it again")
        for peer in tuple(self._peers.values()):
            if peer.backlog:
                self._postpone(peer, frames)
                self._flush(peer)
            else:
                self._deliver(peer, frames)

    def _deliver(self, peer: _Peer, datagram: bytes) -> None:
        try:
            peer.socket.send(datagram)
        except BlockingIOError:
            self._postpone(peer, datagram)
        except (ConnectionError, FileNotFoundError):
            self._forget(peer)

    def _postpone(self, peer: _Peer, datagram: bytes) -> None:
        room = max(0, self.BACKLOG * FRAME_SIZE - len(peer.backlog))
        peer.backlog += datagram[:room]
        self.dropped += max(0, len(datagram) - room) // FRAME_SIZE

    def _flush(self, peer: _Peer) -> None:
        backlog, peer.backlog = peer.backlog, b""
        self._deliver(peer, backlog)

    def _forget(self, peer: _Peer, unlink: bool = True) -> None:
        peer.socket.close()
        self._peers.pop(peer.path.name, None)
        if unlink:
            peer.path.unlink(missing_ok=True)

    def recv_frames(self) -> bytes:
        """Return the frames of the next datagram."""
        try:
            while True:
                datagram = self._socket.recv(65536)
                if datagram.startswith(_GREETING):
                    self._meet(datagram[len(_GREETING) :].decode("ascii", "replace").replace("/", "_"))
                elif datagram and len(datagram) % FRAME_SIZE == 0:
                    self.received_at = time.monotonic_ns()
                    return datagram
        except BlockingIOError:
            return b""
        except OSError as error:
            raise LinkError(f"cannot receive: {error}", link=self.name, remedy="open it again") from error

    def fileno(self) -> int:
        """Return the receiving socket's descriptor."""
        return self._socket.fileno()

    def close(self) -> None:
        """Leave the channel, with a last attempt to deliver what is kept back, and remove the socket."""
        with contextlib.suppress(OSError):
            for peer in tuple(self._peers.values()):
                if peer.backlog:
                    self._flush(peer)
        for peer in tuple(self._peers.values()):
            self._forget(peer, unlink=False)
        self._socket.close()
        self._path.unlink(missing_ok=True)
