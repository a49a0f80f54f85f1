"""The speed caps of a regime, in the gate of this driver and in the drives themselves (max motor speed, object 0x6080).

A drive that does not obey is then no faster than its regime. The object is written over SDO while the robot runs, one
transfer on each channel and tick, and read back. A faster regime is announced before it begins: the drives come first
and the gate last; a slower one closes the gate once commands have had the time to become slower, and then the drives.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from sher3_common import Sher3Error, parse_json
from sher3_common.reasons import Reason
from sher3_common.vectors import Vector
from sher3_description import ACTUATORS

from sher3_drivers.bus.frame import bundle, pack_frame
from sher3_drivers.canopen.objects import MAX_MOTOR_SPEED, NODE_IDS, SDO_REQUEST_BASE, SDO_RESPONSE_BASE
from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.trips import Trip

_ADDRESS = MAX_MOTOR_SPEED.main.to_bytes(2, "little") + bytes([MAX_MOTOR_SPEED.sub])
_WRITE, _READ = b"\x23" + _ADDRESS, b"\x40" + _ADDRESS
_WRITTEN, _VALUE, _ABORT = b"\x60" + _ADDRESS, b"\x43" + _ADDRESS, 0x80
"""Expedited SDO transfers of four bytes (CiA 301): requests, and how their answers begin."""
_SLOWING = 100_000_000
"""Time that commands have for becoming slower, ns: five times the longest age of one that still acts."""


class _Transfer(NamedTuple):
    """One SDO transfer: node id, request, and how its answer must begin."""

    node: int
    request: bytes
    answer: bytes


class SpeedLimits:
    """The caps in force.

    Args:
        scales: scales of the five axes.
        settings: caps by regime, and the regime at the start; without caps the velocity limits hold in every regime.

    Attributes:
        regime: the regime whose caps the drives have, or are getting.
        caps: what the gate lets pass (5,) [m/s, rad/s].
    """

    def __init__(self, scales: Sequence[AxisScale], settings: MotorDriverSettings) -> None:
        self._scales, self._patience = tuple(scales), round(settings.sdo_limit * 1e9)
        self._by_regime: Mapping[str, Vector] = {caps.regime: caps.caps for caps in settings.caps}
        self._channels = [[NODE_IDS[name] for name in channel.drives] for channel in settings.channels]
        self._waiting: list[deque[_Transfer]] = [deque() for _ in settings.channels]
        self._asked: list[_Transfer | None] = [None] * len(settings.channels)
        self._begin = self._deadline = 0
        self._after: Vector | None = None
        self._failed = False
        self.regime = settings.regime
        self.caps = self._of(settings.regime)

    def _of(self, regime: str) -> Vector:
        limits = tuple([scale.velocity_limit for scale in self._scales])
        return tuple(map(min, limits, self._by_regime.get(regime, limits)))

    def scales(self) -> list[AxisScale]:
        """Return the scales with the largest motor speeds of the regime, for drives that are configured."""
        speeds = self._motor_speeds()
        return [replace(scale, max_motor_speed=speed) for scale, speed in zip(self._scales, speeds, strict=True)]

    def _motor_speeds(self) -> list[int]:
        """Return the caps in rpm, rounded up."""
        rounding = 1e-6
        rpm = [cap / (scale.velocity * 1e6) for cap, scale in zip(self._of(self.regime), self._scales, strict=True)]
        return [math.ceil(value - rounding) for value in rpm]

    def hear(self, text: str, now: int) -> None:
        """Take the settings of the motion modes as they are published; the regime that comes is what counts."""
        try:
            data = parse_json(text)
        except Sher3Error:
            return
        regime = data.get("coming", data.get("regime")) if isinstance(data, dict) else None
        if isinstance(regime, str) and regime in self._by_regime and regime != self.regime:
            self._change(regime, now)

    def recover(self, now: int) -> None:
        """Begin again with a regime that a drive did not take, in a recovery."""
        if self._failed:
            self._change(self.regime, now)

    def _change(self, regime: str, now: int) -> None:
        self._failed = False
        before, self.regime = self._of(self.regime), regime
        after = self._of(regime)
        slower = any(new < old for new, old in zip(after, before, strict=True))
        self._begin = now + _SLOWING if slower else now
        self._deadline = self._begin + self._patience
        self._after = after
        speeds = dict(zip(NODE_IDS.values(), self._motor_speeds(), strict=True))
        for channel, nodes in enumerate(self._channels):
            self._asked[channel] = None
            self._waiting[channel] = deque()
            for node in nodes:
                value = speeds[node].to_bytes(4, "little")
                self._waiting[channel].append(_Transfer(node, _WRITE + value, _WRITTEN))
                self._waiting[channel].append(_Transfer(node, _READ + bytes(4), _VALUE + value))

    def frames(self, now: int) -> bytes:
        """Return the SDO requests of a tick as a bundle; nothing while all drives have their caps."""
        if self._after is None or now < self._begin:
            return b""
        self.caps = tuple(map(min, self.caps, self._after))
        parts = []
        for channel, waiting in enumerate(self._waiting):
            ask = waiting.popleft() if self._asked[channel] is None and waiting else None
            if ask is not None:
                self._asked[channel] = ask
            parts.append(b"" if ask is None else pack_frame(SDO_REQUEST_BASE + ask.node, ask.request))
        if not any(self._waiting) and not any(self._asked):
            self.caps, self._after = self._after, None
        return bundle(parts)

    def answer(self, channel: int, can_id: int, data: bytes) -> Trip | None:
        """Take a frame; object when a drive refuses its cap or reads another one back."""
        asked = self._asked[channel] if channel < len(self._asked) else None
        if asked is None or can_id != SDO_RESPONSE_BASE + asked.node or data[1:4] != _ADDRESS:
            return None
        if data.startswith(asked.answer):
            self._asked[channel] = None
            return None
        said = "refuses" if data[0] == _ABORT else f"has {int.from_bytes(data[4:], 'little')} rpm instead of"
        return self._give_up(f"{ACTUATORS[asked.node - 1]}: {said} the speed limit of the regime {self.regime}")

    def overdue(self, now: int) -> Trip | None:
        """Object when the drives have not taken their caps within `sdo_limit`."""
        if self._after is None or now <= self._deadline:
            return None
        silent = [ACTUATORS[asked.node - 1] for asked in self._asked if asked is not None]
        names = ", ".join(silent) or "drives"
        return self._give_up(f"{names}: no answer to the speed limit of the regime {self.regime}")

    def _give_up(self, text: str) -> Trip:
        """Leave the gate at the slower caps until a recovery tries again."""
        self._failed = True
        if self._after is not None:
            self.caps = tuple(map(min, self.caps, self._after))
        self._after = None
        self._asked = [None] * len(self._asked)
        for waiting in self._waiting:
            waiting.clear()
        return Trip(Reason.DRIVE_UNLIMITED, text)
