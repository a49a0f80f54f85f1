"""The CAN link: send and receive many raw frames per call, over whatever carries them.

A specification `kind:channel` names a link. The same driver runs on every kind:

- `socketcan:can0`: hardware, or the kernel's virtual CAN;
- `local:drives/0`: between processes of one user on one machine, without a kernel module;
- `virtual:drives0`: within one process, deterministic, for tests.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Protocol

from sher3_common.waiting import wait_readable

from sher3_drivers.bus.local import LocalCable, LocalLink
from sher3_drivers.bus.socketcan import SocketCanLink
from sher3_drivers.bus.virtual import VirtualLink
from sher3_drivers.errors import LinkError


class CanLink(Protocol):
    """One participant of a CAN bus.

    Attributes:
        name: the specification it was opened with.
        dropped: number of frames that could not be delivered since the link was opened.
    """

    name: str

    @property
    def dropped(self) -> int:
        """Number of frames that could not be delivered since the link was opened."""

    def send_frames(self, frames: bytes) -> None:
        """Send whole 16-byte frames in order, without blocking.

        Raises:
            LinkError: the link cannot take them.
            FrameError: the bytes are no whole number of frames.
        """

    def recv_frames(self) -> bytes:
        """Return waiting frames, one or many, error frames included, in order; b"" when none waits.

        One call may leave some behind: call it until it returns b"" to have all. A link never returns its own frames.

        Raises:
            LinkError: the link cannot be read.
        """

    def fileno(self) -> int:
        """Return a descriptor that is readable when frames wait; -1 for a link within the process, which has none."""

    def close(self) -> None:
        """Leave the bus; closing twice is allowed."""


KINDS: dict[str, type[CanLink]] = {"socketcan": SocketCanLink, "local": LocalLink, "virtual": VirtualLink}


def open_link(specification: str) -> CanLink:
    """Open the link that a specification `kind:channel` names.

    Raises:
        LinkError: the kind is unknown, the interface does not exist, or the channel name is not plain.
    """
    kind, separator, channel = specification.partition(":")
    if kind not in KINDS or not separator or not channel:
        remedy = f"use kind:channel with kind one of {', '.join(KINDS)}"
        raise LinkError("unknown specification", link=specification, value=kind, limit=", ".join(KINDS), remedy=remedy)
    return KINDS[kind](channel)  # type: ignore[call-arg]


def open_links(specifications: Sequence[str]) -> list[CanLink]:
    """Open one link per channel; channels of one local cable share it, so that a tick on all of them is one datagram.

    Raises:
        LinkError: a link cannot be opened (see `open_link`), or a channel is named twice. No link is left open then.
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


def wait_frames(link: CanLink, timeout: float) -> bytes:
    """Return the frames that wait on `link`; wait at most `timeout` s for the first one."""
    deadline = time.monotonic() + timeout
    frames = link.recv_frames()
    while not frames and link.fileno() >= 0 and (left := deadline - time.monotonic()) > 0:
        wait_readable((link.fileno(),), left)
        frames = link.recv_frames()
    return frames
