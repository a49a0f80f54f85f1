"""The host's SDO and NMT services over a CanLink, by the `canopen` library, without a thread.

The library waits for an SDO response on a queue that a thread fills; here the wait itself receives. Cyclic frames that
come in meanwhile are dropped: the cyclic path starts after the configuration.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from functools import partial

import canopen
from canopen.nmt import NmtMaster
from canopen.sdo import SdoAbortedError, SdoClient, SdoCommunicationError

from sher3_drivers.bus.frame import ERROR_FLAG, REMOTE_FLAG, iter_frames, pack_frame
from sher3_drivers.bus.link import CanLink, wait_frames
from sher3_drivers.canopen.configuration import holds
from sher3_drivers.canopen.dictionary import drive_dictionary
from sher3_drivers.canopen.objects import (
    BOOT_UP,
    HEARTBEAT_BASE,
    OBJECTS,
    OPERATIONAL,
    SDO_REQUEST_BASE,
    SDO_RESPONSE_BASE,
    Address,
)
from sher3_drivers.errors import DriveMismatch, DriveSilent

_CHECK = "check power, node id, bit rate and the channel it is configured on"
NO_OBJECT, NO_SUB_INDEX, READ_ONLY = 0x06020000, 0x06090011, 0x06010002
"""SDO abort codes of CiA 301: there is no such object, no such sub-index, and it cannot be written."""
REPEAT = 0.1
"""Seconds after which an NMT command is repeated while its effect does not show.

CANopen confirms no NMT command. Either the command or the one heartbeat that answers it may have been delayed.
"""


class _LinkNetwork(canopen.Network):
    """A canopen network whose bus is a CanLink and which receives when it is told to."""

    def __init__(self, link: CanLink) -> None:
        super().__init__()
        self._link = link
        self.waits = link.fileno() >= 0

    def send_message(self, can_id: int, data: bytes, remote: bool = False) -> None:
        self._link.send_frames(pack_frame(can_id | REMOTE_FLAG * remote, bytes(data)))

    def pump(self, timeout: float) -> bool:
        """Hand every waiting frame to its subscribers; return False when none came within `timeout` s.

        Frames that wait already are taken even when the time is over: this process may have been kept from running.
        """
        frames = wait_frames(self._link, timeout)
        for frame in iter_frames(frames):
            if not frame.can_id & (ERROR_FLAG | REMOTE_FLAG):
                self.notify(frame.can_id, bytearray(frame.data), time.time())
        return bool(frames)


class _PumpedClient(SdoClient):
    """An SDO client that receives frames while it waits for its answer."""

    network: _LinkNetwork

    def read_response(self) -> bytes:
        deadline = time.monotonic() + self.RESPONSE_TIMEOUT
        while self.responses.empty():
            if not self.network.pump(deadline - time.monotonic()):
                raise SdoCommunicationError(f"no response within {self.RESPONSE_TIMEOUT:g} s")
        return super().read_response()


class CanopenMaster:
    """SDO access and NMT commands to the drives of one channel.

    Args:
        link: the channel's link.
        drives: node id of every drive on it, by name.
        sdo_limit: longest wait for a response, s.
    """

    def __init__(self, link: CanLink, drives: dict[str, int], sdo_limit: float = 0.3) -> None:
        self.drives = drives
        self._network = _LinkNetwork(link)
        self._clients: dict[str, _PumpedClient] = {}
        self._nmt: dict[str, NmtMaster] = {}
        self._heard: dict[str, int] = {}
        for name, node_id in drives.items():
            client = _PumpedClient(SDO_REQUEST_BASE + node_id, SDO_RESPONSE_BASE + node_id, drive_dictionary())
            client.network = self._network
            client.RESPONSE_TIMEOUT = sdo_limit
            self._network.subscribe(client.tx_cobid, client.on_response)
            self._clients[name] = client
            self._nmt[name] = NmtMaster(node_id)
            self._nmt[name].network = self._network
            self._nmt[name].add_heartbeat_callback(partial(self._heard.__setitem__, name))
            self._network.subscribe(HEARTBEAT_BASE + node_id, self._nmt[name].on_heartbeat)

    def read(self, drive: str, address: Address) -> int | None:
        """Return the value of an object; None for an optional object that the drive does not have.

        Raises:
            DriveSilent: no answer in time, or the drive does not have the object.
        """
        try:
            data = self._clients[drive].upload(address.main, address.sub)
        except (SdoCommunicationError, SdoAbortedError) as error:
            if _is_missing(error) and OBJECTS[address].optional:
                return None
            raise _silent(drive, f"cannot read {address} ({OBJECTS[address].name}): {error}") from error
        return OBJECTS[address].unpack(data)

    def write(self, drive: str, address: Address, value: int) -> None:
        """Write the value of an object; one that is optional may be missing or read only, and is judged by its value.

        Raises:
            DriveSilent: no answer in time, or the drive refuses.
        """
        try:
            self._clients[drive].download(address.main, address.sub, OBJECTS[address].pack(value))
        except (SdoCommunicationError, SdoAbortedError) as error:
            if _is_missing(error, READ_ONLY) and OBJECTS[address].optional:
                return
            raise _silent(drive, f"cannot write {address} ({OBJECTS[address].name}): {error}") from error

    def command(self, drive: str, state: str) -> None:
        """Send an NMT command: `OPERATIONAL`, `PRE-OPERATIONAL`, `STOPPED`, `RESET` or `RESET COMMUNICATION`."""
        self._nmt[drive].state = state

    def reset(self, limit: float) -> None:
        """Restart every drive, so that nothing of a former run is left; wait at most `limit` s for its boot-up message.

        A drive that gets its power while we wait sends that message by itself.

        Raises:
            DriveSilent: a drive does not boot.
        """
        self._command_all("RESET", BOOT_UP, limit, "does not boot after a reset", repeat=limit)

    def start(self, limit: float) -> None:
        """Bring every drive to OPERATIONAL and wait, at most `limit` s, until its heartbeat says so.

        Raises:
            DriveSilent: a drive does not say it.
        """
        self._command_all("OPERATIONAL", OPERATIONAL, limit, "does not become OPERATIONAL")

    def _command_all(self, command: str, wanted: int, limit: float, failure: str, repeat: float = REPEAT) -> None:
        """Command every drive until its heartbeat says the NMT state `wanted`, again every `repeat` s.

        Raises:
            DriveSilent: a drive does not say it within `limit` s; the error says `failure`.
        """
        self._heard.clear()
        deadline = time.monotonic() + limit
        while missing := self._not_in(wanted, self.drives):
            for name in missing:
                self.command(name, command)
            self._listen(missing, wanted, min(deadline, time.monotonic() + repeat))
            if time.monotonic() >= deadline or not self._network.waits:
                break
        for name in self._not_in(wanted, self.drives):
            raise DriveSilent(name, failure, value=self._heard.get(name), limit=f"{limit:g} s", remedy=_CHECK)

    def _not_in(self, wanted: int, names: Iterable[str]) -> list[str]:
        """Return those of the drives whose newest heartbeat did not say the NMT state `wanted`."""
        return [name for name in names if self._heard.get(name) != wanted]

    def _listen(self, names: Sequence[str], wanted: int, until: float) -> None:
        """Receive until all these drives are in the NMT state `wanted`, or the monotonic time is `until` (s)."""
        while self._not_in(wanted, names) and self._network.pump(until - time.monotonic()):
            pass

    def configure(
        self, drive: str, writes: list[tuple[Address, int]], required: dict[Address, int]
    ) -> tuple[Address, ...]:
        """Bring a drive to PRE-OPERATIONAL, write its objects and read every required one back.

        Returns:
            The optional objects that the drive does not have.

        Raises:
            DriveSilent: the drive does not answer.
            DriveMismatch: objects do not hold what they must; all of them are named.
        """
        self.command(drive, "PRE-OPERATIONAL")
        for address, value in writes:
            self.write(drive, address, value)
        return self.verify(drive, required)

    def verify(self, drive: str, required: dict[Address, int]) -> tuple[Address, ...]:
        """Read every required object; return the optional ones that the drive does not have.

        Raises:
            DriveSilent: the drive does not answer.
            DriveMismatch: objects do not hold what they must; all of them are named.
        """
        found = {address: self.read(drive, address) for address in required}
        wrong: list[tuple[str, object, object]] = [
            (f"{address} ({OBJECTS[address].name})", _shown(required[address]), _shown(value))
            for address, value in found.items()
            if value is not None and not holds(address, value, required[address])
        ]
        if wrong:
            raise DriveMismatch(drive, wrong)
        return tuple([address for address, value in found.items() if value is None])


def _is_missing(error: Exception, *others: int) -> bool:
    """Return whether a drive says that it does not have an object, or refuses it for one of `others` (abort codes)."""
    return isinstance(error, SdoAbortedError) and error.code in (NO_OBJECT, NO_SUB_INDEX, *others)


def _shown(value: int) -> str:
    return f"{value} (0x{value & 0xFFFFFFFF:X})"


def _silent(drive: str, what: str) -> DriveSilent:
    return DriveSilent(drive, what, remedy=_CHECK)
