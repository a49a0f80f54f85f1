"""Each watch has a row that only it can answer, and one in which it is blinded: what the rows of the matrix ask for."""

import re
from pathlib import Path

import pytest
import sher3_control
import sher3_drivers
from sher3_safety.rows.stepped import ROWS
from sher3_safety.rows.witnesses import BESIDE, WITNESSES

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
    bars = alone.effect == "barred" and witness.reason in alone.why
    assert bars or (alone.reasons == (witness.reason,) and alone.effect in ("stops", "said"))
    assert witness.instead in blinded.reasons or (not witness.instead and blinded.effect in ("barred", "residual"))
    assert witness.reason not in blinded.reasons


def test_every_watch_of_motion_and_hand_has_its_rows():
    said = {name for path in WATCHES for name in re.findall(r"Reason\.([A-Z_]+)", path.read_text())}
    assert said == {witness.reason for witness in WITNESSES} & said | set(BESIDE)
    assert len(said) >= 15 and not {witness.reason for witness in WITNESSES} & set(BESIDE)
