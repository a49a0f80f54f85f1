"""The records of each tick as typed messages beside the texts, for tools that plot how old the used samples were.

A record is made a thousand times a second, so it is packed in one step; `codec.packed` would take ten times as long.
"""

from __future__ import annotations

import struct
from functools import partial

from sher3_common.stamps import SECOND
from sher3_description import NAMESPACE, Qos

from sher3_bags.codec.packed import ENCAPSULATION
from sher3_bags.recording.made import Made

_LAW = struct.Struct("<iI I4x qqqq ?? 2x I")
_MOTION = struct.Struct("<iI I4x qqq ?BB x I")
"""Stamp, empty name of a frame (a length of one, a zero byte, padding) and the numbers, as CDR lays them out."""
_made = partial(Made, qos=Qos())


def typed_tick(topic: str, text: str) -> list[Made]:
    """Return the typed twin of a tick record, the numbers of a line of text on one of `TICKS`; none from garbage."""
    try:
        kind, data = TICKS[topic](*map(int, text.split()))
    except (TypeError, ValueError, struct.error):
        return []
    name = kind.replace("Tick", "_tick").lower()
    return [_made(f"{NAMESPACE}/typed/{name}", f"sher3_msgs/msg/{kind}", data=ENCAPSULATION + data)]


def _law(
    tick: int, stamp: int, wrench: int, pedal: int, joints: int, enabled: int, owner: int, version: int
) -> tuple[str, bytes]:
    return "AdmittanceTick", _LAW.pack(
        *divmod(stamp, SECOND), 1, tick, wrench, pedal, joints, bool(enabled), bool(owner), version
    )


def _motion(
    tick: int, stamp: int, joints: int, twist: int, enabled: int, mode: int, reason: int, version: int
) -> tuple[str, bytes]:
    return "MotionTick", _MOTION.pack(
        *divmod(stamp, SECOND), 1, tick, joints, twist, bool(enabled), mode, reason, version
    )


TICKS = {"admittance/inputs": _law, "motion/inputs": _motion}
"""Topic of the text, with what packs its numbers."""
