"""The CAN link: send and receive many raw frames per call, over whatever carries them.

Back-ends are named by a specification `kind:channel`: `socketcan:can0` (hardware or vcan), `local:drives/0` (between
processes of one user on one machine, no kernel module, never leaves it), `virtual:drives0` (within one process,
deterministic). The same driver runs on each.
"""

from __future__ import annotations

import select
import time
from collections.abc import Callable, Sequence
from typing import Protocol

from .bus_local import LocalCable, LocalLink
from .bus_socketcan import SocketCanLink
from .bus_virtual import VirtualLink
from .errors import LinkError
from .frame import bundle, unbundle


class CanLink(Protocol):
    """One participant of a CAN bus.

    Attributes:
        name: the specification it was opened with.
        dropped: frames that could not be delivered since the link was opened.
    """

    name: str

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


def open_links(specifications: Sequence[str]) -> list[CanLink]:
    """Open one link per channel; those of one local cable share it, so that a tick on all of them is one datagram.

    Raises:
        LinkError: as `open_link`, or a channel is named twice; none is left open.
    """
    cables: dict[str, LocalCable] = {}
    links: list[CanLink] = []
    try:
        for specification in specifications:
            kind, _, channel = specification.partition(":")
            name = channel.partition("/")[0]
            if kind == "local" and name in cables:
                links.append(LocalLink(channel, cables[name]))
            else:
                links.append(open_link(specification))
                if isinstance(links[-1], LocalLink):
                    cables[name] = links[-1].cable
    except LinkError:
        for link in links:
            link.close()
        raise
    return links


class LinkGroup:
    """Several links used together, one per CAN channel: bundles of frames in and out (`frame.bundle`).

    Links that share a local cable are one socket; any others are written, read and waited on one by one.

    Attributes:
        links: the links.
        waits: whether there is something to wait on; not so within the process.
        failures: links that could not be read, by index; they are left alone from then on.
    """

    def __init__(self, links: Sequence[CanLink]) -> None:
        self.links = tuple(links)
        self.failures: dict[int, LinkError] = {}
        self._by_descriptor = {link.fileno(): (i, link) for i, link in enumerate(self.links) if link.fileno() >= 0}
        self._cable = _shared_cable(self.links)
        self.waits = all(link.fileno() >= 0 for link in self.links)

    def receive(self, timeout: float = 0.0) -> bytes:
        """Return the next frames of every channel that has some, waiting at most `timeout` s for the first.

        Links within the process are never waited on. `select` and not `poll`: its timeout resolves microseconds, not
        milliseconds.
        """
        cable = self._cable
        if cable is None:
            return self._receive_each(timeout)
        if timeout > 0.0 and self.waits and not select.select(self._by_descriptor, (), (), timeout)[0]:
            return b""
        try:
            return cable.receive()
        except LinkError as error:
            self._cable, self._by_descriptor = None, {}
            self.failures = dict.fromkeys(range(len(self.links)), error)
            return b""

    def _receive_each(self, timeout: float) -> bytes:
        if self.waits:
            ready, _, _ = select.select(self._by_descriptor, (), (), timeout if timeout > 0.0 else 0.0)
            candidates = [self._by_descriptor[descriptor] for descriptor in ready]
        else:
            candidates = [(index, link) for index, link in enumerate(self.links) if index not in self.failures]
        parts = [b""] * len(self.links)
        for index, link in candidates:
            try:
                parts[index] = link.recv_frames()
            except LinkError as error:
                self._leave_alone(index, error)
        return bundle(parts)

    def _leave_alone(self, index: int, error: LinkError) -> None:
        self.failures[index] = error
        self._by_descriptor = {fd: entry for fd, entry in self._by_descriptor.items() if entry[0] != index}

    def send(self, frames: bytes) -> Sequence[tuple[int, LinkError]]:
        """Send a bundle; return (channel, error) of those that cannot take their frames; the others get theirs."""
        if self._cable is not None:
            try:
                self._cable.send(frames)
            except LinkError as error:
                return [(index, error) for index in range(len(self.links))]
            return ()
        failures = []
        for index, part in enumerate(unbundle(frames, len(self.links))):
            try:
                if part:
                    self.links[index].send_frames(part)
            except LinkError as error:
                failures.append((index, error))
        return failures

    def close(self) -> None:
        """Close every link."""
        for link in self.links:
            link.close()


def _shared_cable(links: Sequence[CanLink]) -> LocalCable | None:
    """Return the cable of which these links are the channels 0, 1, ...; None when there is no such cable."""
    cables = [link.cable if isinstance(link, LocalLink) and link.number == i else None for i, link in enumerate(links)]
    return cables[0] if len(set(cables)) == 1 else None


class LockstepLink:
    """A link whose `recv_frames` first calls the functions of `other_side`: one thread drives both ends."""

    def __init__(self, link: CanLink, other_side: Sequence[Callable[[], object]] = ()) -> None:
        self._link = link
        self._other_side = other_side
        self.name = link.name

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
