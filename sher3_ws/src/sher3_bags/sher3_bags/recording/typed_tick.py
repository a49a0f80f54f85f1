"""The records of each tick as typed messages beside the texts, for tools that plot how old the used samples were.

A record is made a thousand times a second, so it is packed in one step; `codec.packed` would take ten times as long.
"""

from __future__ import annotations

import struct
from collections.abc import Callable

from sher3_common.stamps import SECOND
from sher3_description import NAMESPACE, Qos

from sher3_bags.codec.packed import ENCAPSULATION
from sher3_bags.recording.made import Made

_LAW = struct.Struct("<iI I4x qqqq ?? 2x I")
_MOTION = struct.Struct("<iI I4x qqq ?BB x I")
"""Stamp, empty name of a frame (a length of one, a zero byte, padding) and the numbers, as CDR lays them out."""
_QOS = Qos()


def typed_tick(topic: str, text: str) -> list[Made]:
    """Return the typed twin of a tick record, the numbers of a line of text on one of `TICKS`; none from garbage."""
    try:
        name, kind, pack = TICKS[topic]
        return [Made(name, kind, _QOS, ENCAPSULATION + pack(*map(int, text.split())))]
    except (TypeError, ValueError, struct.error):
        return []


def _law(tick: int, stamp: int, wrench: int, pedal: int, joints: int, enabled: int, owner: int, version: int) -> bytes:
    return _LAW.pack(*divmod(stamp, SECOND), 1, tick, wrench, pedal, joints, bool(enabled), bool(owner), version)


def _motion(
    tick: int, stamp: int, joints: int, twist: int, enabled: int, mode: int, reason: int, version: int
) -> bytes:
    return _MOTION.pack(*divmod(stamp, SECOND), 1, tick, joints, twist, bool(enabled), mode, reason, version)


TICKS: dict[str, tuple[str, str, Callable[..., bytes]]] = {
    "admittance/inputs": (f"{NAMESPACE}/typed/admittance_tick", "sher3_msgs/msg/AdmittanceTick", _law),
    "motion/inputs": (f"{NAMESPACE}/typed/motion_tick", "sher3_msgs/msg/MotionTick", _motion),
}
"""Topic of the text, with topic, type and packer of its twin."""
