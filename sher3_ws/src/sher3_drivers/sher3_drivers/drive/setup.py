"""Bringing five drives from any state to OPERATIONAL, configured and verified, without power."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_drivers.bus.link import CanLink
from sher3_drivers.canopen.configuration import required_values, required_writes
from sher3_drivers.canopen.master import CanopenMaster
from sher3_drivers.canopen.objects import NODE_IDS
from sher3_drivers.canopen.other_host import refuse_other_host
from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.units import AxisScale


def set_up_drives(
    links: Sequence[CanLink], settings: MotorDriverSettings, scales: Sequence[AxisScale], patience: float
) -> dict[str, tuple[str, ...]]:
    """Restart every drive, write its configuration, verify it by read-back, and bring all of them to OPERATIONAL.

    Before the first command it listens for anybody else who commands these drives.

    Args:
        links: one link per channel.
        settings: channels and limits.
        scales: scales of the five axes, in the order of ACTUATORS.
        patience: longest wait for a drive to boot, s.

    Returns:
        The optional objects that each drive does not have.

    Raises:
        OtherHost: somebody does; nothing is sent, so that the robot goes on.
        DriveSilent: a drive does not answer.
        DriveMismatch: a drive does not hold what it must. No drive becomes OPERATIONAL.
    """
    refuse_other_host(links, settings.host_id)
    masters = [
        CanopenMaster(link, {name: NODE_IDS[name] for name in channel.drives}, settings.sdo_limit)
        for link, channel in zip(links, settings.channels, strict=True)
    ]
    for master in masters:
        master.reset(patience)
    absent = {}
    for master in masters:
        for name, node_id in master.drives.items():
            scale = scales[node_id - 1]
            writes = required_writes(node_id, scale, settings)
            missing = master.configure(name, writes, required_values(node_id, scale, settings))
            absent[name] = tuple(map(str, missing))
    for master in masters:
        master.start(patience)
    return absent
