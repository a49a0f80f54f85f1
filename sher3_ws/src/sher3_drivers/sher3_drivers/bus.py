"""The CAN link: send and receive many raw frames per call, over whatever carries them.

Back-ends are named by a specification `kind:channel`: `socketcan:can0` (hardware or vcan), `local:drives0` (between
processes of one user on one machine, no kernel module, never leaves it), `virtual:drives0` (within one process,
deterministic). The same driver runs on each.
"""

from __future__ import annotations

import select
import time
from collections.abc import Callable, Sequence
from typing import Protocol

from .bus_local import LocalLink
from .bus_socketcan import SocketCanLink
from .bus_virtual import VirtualLink
from .errors import LinkError


class CanLink(Protocol):
    """One participant of a CAN bus.

    Attributes:
        name: the specification it was opened with.
        received_at: CLOCK_MONOTONIC [ns] when the newest frame of the last non-empty `recv_frames` came in.
        dropped: frames that could not be delivered since the link was opened.
    """

    name: str

    @property
    def received_at(self) -> int:
        """When the newest frame came in, CLOCK_MONOTONIC [ns]."""

    @property
    def dropped(self) -> int:
        """Frames that could not be delivered."""

    def send_frames(self, frames: bytes) -> None:
        """Send whole 16-byte frames in order without blocking; raise LinkError when the link cannot take them."""

    def recv_frames(self) -> bytes:
        """Return the next frames that wait, one or many, error frames included, in order; b"" when none waits.

        Own frames never come back. Call it again until it returns nothing to have all.
        """

    def fileno(self) -> int:
        """Return a descriptor that is readable when frames wait, or -1 when there is none (in process)."""

    def close(self) -> None:
        """Leave the bus; closing twice is allowed."""


KINDS: dict[str, type[CanLink]] = {"socketcan": SocketCanLink, "local": LocalLink, "virtual": VirtualLink}


def open_link(specification: str) -> CanLink:
    """Open the link `kind:channel`.

    Raises:
        LinkError: unknown kind, no such interface, or a channel name that is not plain.
    """
    kind, separator, channel = specification.partition(":")
    if kind not in KINDS or not separator or not channel:
        remedy = f"use kind:channel with kind one of {', '.join(KINDS)}"
        raise LinkError("unknown specification", link=specification, value=kind, limit=", ".join(KINDS), remedy=remedy)
    return KINDS[kind](channel)  # type: ignore[call-arg]


class LinkGroup:
    """Several links waited on together, one per CAN channel.

    Attributes:
        links: the links.
        waits: whether there is something to wait on; not so within the process.
        failures: links that could not be read, by index; they are left alone from then on.
    """

    def __init__(self, links: Sequence[CanLink]) -> None:
        self.links = tuple(links)
        self.failures: dict[int, LinkError] = {}
        self._by_descriptor = {link.fileno(): (i, link) for i, link in enumerate(self.links) if link.fileno() >= 0}
        self.waits = len(self._by_descriptor) == len(self.links)

    def receive(self, timeout: float = 0.0) -> list[tuple[int, bytes]]:
        """Return (index of the link, next frames) of every link that has some, waiting at most `timeout` s.

        Links within the process are never waited on. `select` and not `poll`: its timeout resolves microseconds, not
        milliseconds, and one call in place of a failing read per link is what the hot path can afford.
        """
        if self.waits:
            ready, _, _ = select.select(self._by_descriptor, (), (), timeout if timeout > 0.0 else 0.0)
            candidates = [self._by_descriptor[descriptor] for descriptor in ready]
        else:
            candidates = [(index, link) for index, link in enumerate(self.links) if index not in self.failures]
        received = []
        for index, link in candidates:
            try:
                frames = link.recv_frames()
            except LinkError as error:
                self._leave_alone(index, error)
                continue
            if frames:
                received.append((index, frames))
        return received

    def _leave_alone(self, index: int, error: LinkError) -> None:
        self.failures[index] = error
        self._by_descriptor = {fd: entry for fd, entry in self._by_descriptor.items() if entry[0] != index}

    def send_each(self, frames: Sequence[bytes]) -> None:
        """Send `frames[i]` on link i; empty ones are skipped."""
        for link, part in zip(self.links, frames, strict=True):
            if part:
                link.send_frames(part)

    def close(self) -> None:
        """Close every link."""
        for link in self.links:
            link.close()


class LockstepLink:
    """A link whose `recv_frames` first lets the other side run: one thread drives both ends, on any back-end."""

    def __init__(self, link: CanLink, other_side: Sequence[Callable[[], object]] = ()) -> None:
        self._link = link
        self._other_side = list(other_side)
        self.name = link.name

    def attach(self, poll: Callable[[], object]) -> None:
        """Call `poll()` whenever this link looks for frames."""
        self._other_side.append(poll)

    @property
    def received_at(self) -> int:
        """When the newest frame came in, CLOCK_MONOTONIC [ns]."""
        return self._link.received_at

    @property
    def dropped(self) -> int:
        """Frames that could not be delivered."""
        return self._link.dropped

    def send_frames(self, frames: bytes) -> None:
        """Send whole frames in order."""
        self._link.send_frames(frames)

    def recv_frames(self) -> bytes:
        """Let the other side run, then return what is waiting."""
        for poll in self._other_side:
            poll()
        return self._link.recv_frames()

    def fileno(self) -> int:
        """Nothing to wait on: the other side runs in this thread."""
        return -1

    def close(self) -> None:
        """Leave the bus."""
        self._link.close()


def wait_frames(link: CanLink, timeout: float) -> bytes:
    """Return what is waiting on `link`, waiting at most `timeout` s for the first frame."""
    deadline = time.monotonic() + timeout
    frames = link.recv_frames()
    while not frames and link.fileno() >= 0 and (left := deadline - time.monotonic()) > 0:
        select.select((link.fileno(),), (), (), left)
        frames = link.recv_frames()
    return frames
