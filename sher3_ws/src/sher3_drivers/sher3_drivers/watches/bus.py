"""What controllers and drives say by themselves: error frames, heartbeats, emergency messages; and links that break."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_common.reasons import Reason

from sher3_drivers.bus.condition import BusCondition, decode_error
from sher3_drivers.bus.frame import ERROR_FLAG, Frame
from sher3_drivers.canopen.objects import EMCY_BASE, HEARTBEAT_BASE, NODE_IDS, NODE_MASK, SERVICE_MASK
from sher3_drivers.canopen.other_host import said_by_a_host
from sher3_drivers.errors import LinkError
from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.watches.drives import DriveHealth
from sher3_drivers.watches.trips import Trip


class BusWatch:
    """Judges every frame that is no TPDO.

    Attributes:
        conditions: health of every channel's CAN controller.
        error_frames: number of error frames so far.
    """

    def __init__(self, health: Sequence[DriveHealth], settings: MotorDriverSettings) -> None:
        self.conditions = [BusCondition.ACTIVE] * len(settings.channels)
        self.error_frames = 0
        self._health, self._links = tuple(health), tuple([channel.link for channel in settings.channels])
        self._drives = [{NODE_IDS[name] for name in channel.drives} for channel in settings.channels]
        self._host_id = settings.host_id
        self._broken = 0

    def hear(self, channel: int, can_id: int, data: bytes, now: int) -> Trip | None:
        """Take a frame of a channel at time `now` (ns).

        Frames that only a host sends are not ours, since a link never returns them: whoever sends them could move the
        drives. A drive speaks on its own channel alone. Frames of nodes that are no drive belong to others.
        """
        if channel >= len(self.conditions):
            return None
        if can_id & ERROR_FLAG:
            self.error_frames += 1
            return self._judge_error(channel, Frame(can_id, data))
        node, service = can_id & NODE_MASK, can_id & SERVICE_MASK
        if said := said_by_a_host(can_id, self._host_id):
            return Trip(Reason.OTHER_HOST, f"{self._links[channel]}: {said} of another host")
        if not 1 <= node <= len(self._health):
            return None
        if node not in self._drives[channel]:
            text = (
                f"{self._links[channel]}: 0x{can_id:03x} of {self._health[node - 1].name}, which is not on this channel"
            )
            return Trip(Reason.DRIVE_TWICE, text, can_id, unit="identifier")
        if service == HEARTBEAT_BASE:
            return self._health[node - 1].on_heartbeat(data, now)
        return self._health[node - 1].on_emergency(data) if service == EMCY_BASE else None

    def _judge_error(self, channel: int, frame: Frame) -> Trip | None:
        """Note the condition an error frame reports; object to error passive and bus off."""
        report = decode_error(frame)
        if report is None or report.condition is None:
            return None
        self.conditions[channel] = report.condition
        if report.condition < BusCondition.PASSIVE:
            return None
        reason = Reason.BUS_OFF if report.condition is BusCondition.OFF else Reason.BUS_PASSIVE
        return Trip(reason, f"{self._links[channel]}: {report.text}")

    def lose(self, channel: int, error: LinkError) -> Trip:
        """Return the objection to a link that cannot be used."""
        self.conditions[channel] = BusCondition.OFF
        return Trip(Reason.LINK_LOST, str(error))

    def more_broken(self, count: int) -> bool:
        """Return whether more links can no longer be read than at the last call: `count` of them now."""
        before, self._broken = self._broken, count
        return count > before
