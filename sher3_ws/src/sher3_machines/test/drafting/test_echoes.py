"""A place that repeats what was asked is no measurement; a servo that is late, however coarse its counts, is one."""

import numpy as np
import pytest
from sher3_common import parse_yaml
from sher3_machines.drafting.draft import draft
from sher3_machines.drafting.echoes import echo

TIME = np.arange(0.0, 20.0, 0.02)
ASKED = np.round(100.0 * np.sin(TIME), 1)


def late(rows):
    return np.concatenate([np.full(rows, ASKED[0]), ASKED[: len(ASKED) - rows]])


@pytest.mark.parametrize("rows", [1, 2])
def test_a_finger_that_is_logged_as_it_was_told_is_left_out(tmp_path, rows):
    arm = late(rows) + np.round(np.random.default_rng(0).normal(size=len(TIME)), 1)
    header, columns = "t,arm_pos,arm_ref,finger_pos,finger_ref", (TIME, arm, ASKED, late(rows), ASKED)
    np.savetxt(tmp_path / "a.csv", np.column_stack(columns), delimiter=",", header=header, comments="")
    found = draft(tmp_path / "a.csv")
    assert [axis["name"] for axis in parse_yaml(found.text)["axes"]] == ["arm"]
    assert any(guess.startswith("finger: left out") and f"{rows} rows before" in guess for guess in found.guesses)


@pytest.mark.parametrize("scale", [1.0, 1e-3])
@pytest.mark.parametrize("offset", [0.0, 5.0])
def test_what_was_measured_is_no_echo(scale, offset):
    """Whatever unit and zero: a lag of a row, and counts of a tenth of the travel."""
    behind = np.interp(TIME - 0.03, TIME, ASKED)
    for x, y in ((np.round(behind, 1), ASKED), (np.round(behind, -1), np.round(ASKED, -1)), (ASKED, ASKED)):
        assert echo(scale * x + offset, scale * y + offset) == 0
    assert echo(scale * late(1) + offset, scale * ASKED + offset) == 1
