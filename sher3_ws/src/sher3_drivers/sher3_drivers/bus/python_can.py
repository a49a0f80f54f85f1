"""Any CanLink as a python-can bus, so that `can_viewer` and every other python-can tool works on it.

Example: `can_viewer -i sher3 -c local:drives/0`.
"""

from __future__ import annotations

import select
import time
from typing import Any

import can

from sher3_drivers.bus.frame import ERROR_FLAG, EXTENDED_FLAG, ID_MASK, REMOTE_FLAG, Frame, iter_frames, pack_frame
from sher3_drivers.bus.link import CanLink, open_link


class LinkBus(can.BusABC):
    """python-can bus over a CanLink: `can.Bus(interface="sher3", channel="local:drives/0")`."""

    def __init__(self, channel: str | CanLink, can_filters: Any = None, **kwargs: Any) -> None:
        self._link = open_link(channel) if isinstance(channel, str) else channel
        self._waiting: list[Frame] = []
        self.channel_info = f"sher3 {self._link.name}"
        super().__init__(channel=self._link.name, can_filters=can_filters, **kwargs)

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Send one message without blocking; `timeout` is ignored.

        Raises:
            LinkError: the link cannot take it.
        """
        del timeout
        flags = EXTENDED_FLAG * msg.is_extended_id | REMOTE_FLAG * msg.is_remote_frame | ERROR_FLAG * msg.is_error_frame
        self._link.send_frames(pack_frame(msg.arbitration_id | flags, bytes(msg.data)))

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        """Return the next message within `timeout` s (None: without end), and False: filters are the caller's."""
        deadline = None if timeout is None else time.monotonic() + timeout
        while not self._waiting:
            self._waiting = list(iter_frames(self._link.recv_frames()))[::-1]
            if not self._waiting and not self._wait(deadline):
                return None, False
        return _message(self._waiting.pop()), False

    def _wait(self, deadline: float | None) -> bool:
        """Wait for frames until `deadline`; return False when it has passed or there is nothing to wait on."""
        left = None if deadline is None else deadline - time.monotonic()
        if self._link.fileno() < 0 or (left is not None and left <= 0):
            return False
        select.select((self._link.fileno(),), (), (), left)
        return True

    def fileno(self) -> int:
        """Return the link's descriptor, -1 when it has none."""
        return self._link.fileno()

    def shutdown(self) -> None:
        """Close the link."""
        super().shutdown()
        self._link.close()


def _message(frame: Frame) -> can.Message:
    return can.Message(
        timestamp=time.time(),
        arbitration_id=frame.can_id & ID_MASK,
        is_extended_id=bool(frame.can_id & EXTENDED_FLAG),
        is_remote_frame=bool(frame.can_id & REMOTE_FLAG),
        is_error_frame=bool(frame.can_id & ERROR_FLAG),
        data=frame.data,
    )
