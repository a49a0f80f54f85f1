"""Each watch has a row that only it can answer, and one in which it is blinded: what the rows of the matrix ask for."""

import re
from pathlib import Path
from typing import NamedTuple

import pytest
import sher3_control
import sher3_drivers
from sher3_safety.rows.stepped import ROWS


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

NAMED = {row.name: row for row in ROWS}
WATCHES = [
    *(
        Path(sher3_drivers.__file__).parent / name
        for name in (
            *(f"watches/{check}.py" for check in ("position", "demand", "rest", "frozen", "axis", "fingerprint")),
            "canopen/tpdo.py",
        )
    ),
    *(Path(sher3_control.__file__).parent / f"supervision/{name}.py" for name in ("hand", "zero", "leg_residual")),
]
"""Sources of the watches of motion, of reports and of the hand."""


@pytest.mark.parametrize("witness", WITNESSES, ids=lambda witness: witness.reason)
def test_a_watch_answers_alone_and_others_do_where_it_is_blinded(witness):
    alone, blinded = NAMED[witness.alone], NAMED[witness.blinded]
    bars = alone.expects == "barred" and witness.reason in alone.why
    assert bars or (alone.reasons == (witness.reason,) and alone.expects in ("stops", "said"))
    assert witness.instead in blinded.reasons or (not witness.instead and blinded.expects in ("barred", "residual"))
    assert witness.reason not in blinded.reasons


def test_every_watch_of_motion_and_hand_has_its_rows():
    said = {name for path in WATCHES for name in re.findall(r"Reason\.([A-Z_]+)", path.read_text())}
    assert said == {witness.reason for witness in WITNESSES} & said | set(BESIDE)
    assert len(said) >= 15 and not {witness.reason for witness in WITNESSES} & set(BESIDE)
