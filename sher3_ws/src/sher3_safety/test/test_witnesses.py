"""Each watch has a row that only it can answer, and one in which it is blinded: what the rows of the matrix ask for."""

import pytest
from sher3_safety.rows.stepped import ROWS
from sher3_safety.rows.witnesses import WITNESSES

NAMED = {row.name: row for row in ROWS}


@pytest.mark.parametrize("witness", WITNESSES, ids=lambda witness: witness.reason)
def test_a_watch_answers_alone_and_others_do_where_it_is_blinded(witness):
    alone, blinded = NAMED[witness.alone], NAMED[witness.blinded]
    assert alone.reasons == (witness.reason,) and alone.effect in ("stops", "said")
    assert witness.instead in blinded.reasons or (not witness.instead and blinded.effect in ("barred", "residual"))
    assert witness.reason not in blinded.reasons
