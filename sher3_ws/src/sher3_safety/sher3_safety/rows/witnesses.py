"""For each watch of motion and hand a row in which only it can answer, and one in which it is blinded and others do."""

from __future__ import annotations

from typing import NamedTuple


class Witness(NamedTuple):
    """A watch, by the reason that it gives.

    Attributes:
        reason: code.
        alone: row whose first reason may be no other; or in which it is why the robot is not enabled.
        blinded: row in which the watch sees nothing wrong, or nothing at all.
        instead: reason that is given there; empty where the robot is not enabled, or where the residual is stated.
    """

    reason: str
    alone: str
    blinded: str
    instead: str


WITNESSES = (
    Witness("POSITION_LEFT", "delta_1.power creep (speed 1e-05)", "bus.up late (items 1)", "FEEDBACK_STALE"),
    Witness("DRIVE_DISOBEYS", "delta_1.echo wrong (scale 0)", "delta_1.power creep (speed 0.0001)", "POSITION_LEFT"),
    Witness("ENCODER_FROZEN", "delta_1.load_encoder stuck", "legs.encoders drift (rate 0.0001)", "POSITION_LEFT"),
    Witness("FEEDBACK_STALE", "bus.up late (items 3)", "bus0.up swap", "FEEDBACK_SWAPPED"),
    Witness("FEEDBACK_SWAPPED", "bus0.up swap", "delta_1.up contradicted (first 1)", "DRIVE_TWICE"),
    Witness(
        "DRIVE_UNWILLING", "delta_1.statusword wrong (code 512)", "legs.power creep (speed 0.0001)", "POSITION_LEFT"
    ),
    Witness("HAND_DOUBTFUL", "force_sensor bias (force 1)", "force_sensor bias (force 1), there at enabling", ""),
    Witness("WRENCH_FROZEN", "force_sensor stuck", "force_sensor held, hand gone", "HAND_DOUBTFUL"),
    Witness(
        "MOVED_DISABLED", "delta_1.motor creep (speed 0.001)", "delta_1.power creep (speed 0.001)", "POSITION_LEFT"
    ),
    Witness("FEEDBACK_GARBLED", "delta_1.up garbage", "delta_1.power creep (speed 0.0001)", "POSITION_LEFT"),
    Witness("DRIVE_TWICE", "delta_1.up contradicted (first 0)", "delta_1.up garbage", "FEEDBACK_GARBLED"),
    Witness("DRIVE_SILENT", "delta_1.up off", "bus.up late (items 3)", "FEEDBACK_STALE"),
    Witness(
        "FORCE_UNEXPLAINED",
        "force_sensor bias (force 1), there at enabling",
        "force_sensor bias (force 1)",
        "HAND_DOUBTFUL",
    ),
    Witness("PEDAL_INVALID", "pedal chatter (items 5, code 1)", "pedal stuck, pedal released", ""),
)
"""HAND_DOUBTFUL is blinded by what is there before enabling, which is barred; and by an encoder that jitters, where it
says so itself."""
BESIDE = {
    "ENCODERS_DISAGREE": "the sum of the commands tells the same",
    "FOLLOWING_ERROR": "the sum of the commands tells the same, but where the drive reports a force that explains it",
    "STOP_NOT_OBEYED": "never the first reason (`rows.together`)",
    "LEG_SLIPPED": "needs a tracker, which no robot of the matrix has",
}
"""Reasons of watches of motion and hand without such rows, and why."""
