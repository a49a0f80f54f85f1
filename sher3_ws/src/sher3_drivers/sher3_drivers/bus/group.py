"""Several links used as one: a tick on all channels is one bundle of frames out and one or a few in."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_common.waiting import wait_readable

from sher3_drivers.bus.frame import bundle, unbundle
from sher3_drivers.bus.link import CanLink
from sher3_drivers.bus.local import LocalCable, LocalLink
from sher3_drivers.errors import LinkError


class LinkGroup:
    """One link per CAN channel, used as one: bundles of frames in and out (`frame.bundle`).

    Links that share a local cable are one socket; any others are written, read and waited on one by one.

    Args:
        links: one link per channel.

    Attributes:
        links: the links.
        waits: whether there is something to wait on; links within the process have nothing.
        failures: links that could not be read, by channel. They are not read again.
    """

    def __init__(self, links: Sequence[CanLink]) -> None:
        self.links = tuple(links)
        self.failures: dict[int, LinkError] = {}
        self._by_descriptor = {link.fileno(): (i, link) for i, link in enumerate(self.links) if link.fileno() >= 0}
        self._readable = list(enumerate(self.links))
        self._cable = _shared_cable(self.links)
        self.waits = all(link.fileno() >= 0 for link in self.links)

    def receive(self, timeout: float = 0.0) -> bytes:
        """Return the next frames of every channel that has some; wait at most `timeout` s for the first.

        Links within the process are never waited on.
        """
        cable = self._cable
        if cable is None:
            return self._receive_each(timeout)
        if timeout > 0.0 and self.waits and not wait_readable(self._by_descriptor, timeout):
            return b""
        try:
            return cable.receive()
        except LinkError as error:
            self._cable, self._by_descriptor = None, {}
            self.failures = dict.fromkeys(range(len(self.links)), error)
            return b""

    def _receive_each(self, timeout: float) -> bytes:
        if self.waits:
            ready = wait_readable(self._by_descriptor, timeout)
            candidates = [self._by_descriptor[descriptor] for descriptor in ready]
        else:
            candidates = self._readable
        parts = [b""] * len(self.links)
        for index, link in candidates:
            try:
                parts[index] = link.recv_frames()
            except LinkError as error:
                self._leave_alone(index, error)
        return bundle(parts) if any(parts) else b""

    def _leave_alone(self, index: int, error: LinkError) -> None:
        """Note that a link cannot be read, and wait on it no more."""
        self.failures[index] = error
        self._readable = [entry for entry in self._readable if entry[0] != index]
        self._by_descriptor = {fd: entry for fd, entry in self._by_descriptor.items() if entry[0] != index}

    def send(self, frames: bytes) -> Sequence[tuple[int, LinkError]]:
        """Send a bundle; return (channel, error) of those that cannot take their frames. The others get theirs."""
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
    """Return the cable whose channels 0, 1, ... these links are, in this order; None when there is no such cable."""
    cables = [link.cable if isinstance(link, LocalLink) and link.number == i else None for i, link in enumerate(links)]
    return cables[0] if len(set(cables)) == 1 else None
