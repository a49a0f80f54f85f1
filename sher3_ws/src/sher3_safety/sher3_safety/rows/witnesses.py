"""For each watch of motion and hand a row in which only it can answer, and one in which it is blinded and others do."""

from __future__ import annotations

from typing import NamedTuple


class Witness(NamedTuple):
    """A watch, by the reason that it gives.

    Attributes:
        reason: code.
        alone: row whose first reason may be no other.
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
    Witness("PEDAL_INVALID", "pedal chatter (items 5, code 1)", "pedal stuck, pedal released", ""),
)
"""Not among them: ENCODERS_DISAGREE and FOLLOWING_ERROR, beside which the sum of the commands tells the same; and
STOP_NOT_OBEYED, which is never the first reason (`rows.together`). HAND_DOUBTFUL is blinded by what is there before
enabling, which is barred; and by an encoder that jitters, where it says so itself."""
