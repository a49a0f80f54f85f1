"""What is wrong from before the robot is enabled: plugs, poles and scales of the axes, and a zero that is none.

Each drive checks its own axis alone. So what comes to light depends on which of motor and encoders go with it: one that
stays behind parts from the commands at the first motion; a whole axis under another name obeys in another place, and
only the hand, felt twice, tells.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from sher3_safety.rows.row import AXIS, MOVING, NOBODY, SIDEWAYS, Row, Since

LED = (MOVING, SIDEWAYS)
"""The hand leads the tip along z, where all legs do the same, and along x, where each does something else."""
DOUBTFUL = ("HAND_DOUBTFUL",)
PARTED = ("POSITION_LEFT", "ENCODERS_DISAGREE", "FOLLOWING_ERROR", "ENCODER_FROZEN", *DOUBTFUL)
BARRED = "the zero is not earned: FORCE_UNEXPLAINED"
FALSE = (("bias", "force", 0.18), ("bias", "force", 1.0), ("bias", "torque", 0.03), ("drift", "rate", 0.1))
LONG = 1.0
"""Observation [s]: half a millimetre of travel at 0.5 mm/s."""
SINCE: tuple[Since, ...] = ("enabling", "recovery")
ALIKE = "along z all legs do the same, so that exchanged ones lead the tip where the hand pushes"
SCALES = (
    "2 % of a drive are found once a leg is off by 7 um, those of one encoder, by 10 um and 2 % of the range, never"
)
WHOLE = "the sum of sensor and drives is judged from 0.09 s after enabling on, before the pedal is pressed at 0.18 s"


def _there(component: str, parameters: dict[str, float], fault: str = "wrong", **more: Any) -> Iterator[Row]:
    """Yield what is there at enabling, and when the robot is recovered."""
    told: dict[str, Any] = {"slow": True, "reasons": PARTED, "duration": LONG, "states": LED, "budget": 25e-6, **more}
    yield from (Row(component, fault, parameters, since=since, **told) for since in SINCE)


def _plugs() -> Iterator[Row]:
    """Yield exchanged plugs of two legs, exchanged poles, and scales that are off."""
    exchanged, reversed_poles, alike = {"one": 1.0, "other": 2.0}, {"one": 1.0, "other": 1.0}, (MOVING.name,)
    yield from _there("wires", exchanged, "miswired", quiet=alike, why=ALIKE)
    yield from _there("wires", reversed_poles, "miswired", why=WHOLE)
    for plug in ("motors", "encoder_pairs", "load_encoders", "motor_encoders"):
        yield from _there(f"wires.{plug}", exchanged, "miswired", quiet=alike, why=ALIKE)
        yield from _there(f"wires.{plug}", reversed_poles, "miswired")
    for part in ("power", "demand", "load_encoder", "motor_encoder"):
        yield from _there(f"{AXIS}.{part}", {"scale": 1.02}, expects="either", why=SCALES)


def _zeros() -> Iterator[Row]:
    """Yield a force that nobody exerts, there before the robot is enabled."""
    for kind, name, value in FALSE:
        yield from (
            Row("force_sensor", kind, {name: value}, expects="barred", since=since, duration=LONG, states=(NOBODY,),
                why=BARRED)
            for since in SINCE
        )  # fmt: skip


WIRING = (*_plugs(), *_zeros())
