"""Is there another host on the bus already? Two hosts would command the same drives in turn.

A host that commands drives can be heard: it sends SYNC every control period, its heartbeat, NMT commands, SDO requests
and RPDOs. Drives send none of these (CiA 301, pre-defined connection set), and a link never returns its own frames.
"""

from __future__ import annotations

import time
from collections.abc import Sequence

from sher3_drivers.bus.frame import ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG, iter_frames, unbundle
from sher3_drivers.bus.group import LinkGroup
from sher3_drivers.bus.link import CanLink
from sher3_drivers.canopen.objects import HEARTBEAT_BASE, NMT_ID, NODE_MASK, RPDO_BASE, SDO_REQUEST_BASE, SYNC_ID
from sher3_drivers.errors import OtherHost

LISTEN = 0.030
"""Seconds to listen: six periods of a host's heartbeat, and longer than the 20 ms for which its loop may hang."""


def refuse_other_host(links: Sequence[CanLink], host_id: int, seconds: float = LISTEN) -> None:
    """Listen on every link without sending anything; links within the process are not waited on.

    Args:
        links: one link per channel.
        host_id: CANopen node id of the hosts' heartbeat.
        seconds: how long to listen.

    Raises:
        OtherHost: a frame came that only a host sends.
    """
    group = LinkGroup(links)
    deadline = time.monotonic() + seconds
    while (left := deadline - time.monotonic()) > 0.0:
        frames = group.receive(left)
        if not frames and not group.waits:
            return
        for link, part in zip(links, unbundle(frames, len(links)), strict=True):
            for frame in iter_frames(part):
                if said := said_by_a_host(frame.can_id, host_id):
                    raise OtherHost(link.name, said)


def said_by_a_host(can_id: int, host_id: int) -> str | None:
    """Return what a host says with this identifier; None for identifiers that others use too."""
    if can_id & ERROR_FLAG:
        return None
    if can_id & (EXTENDED_FLAG | REMOTE_FLAG):
        return "extended frame" if can_id & EXTENDED_FLAG else "remote request"
    whole = {NMT_ID: "NMT command", SYNC_ID: "SYNC", HEARTBEAT_BASE + host_id: f"heartbeat of node {host_id}"}
    services = {RPDO_BASE: "RPDO", SDO_REQUEST_BASE: "SDO request"}
    return whole.get(can_id) or services.get(can_id & ~NODE_MASK)
