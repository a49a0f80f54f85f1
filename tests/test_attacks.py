"""Attacks that no list has, a few of those of `bench/more_attacks.py` and `bench/shared_attacks.py`."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "bench"))
import attacks
import more_attacks
import shared_attacks
from attacks import travels

BUDGET = 40e-6
"""Travel near tissue [m]."""
QUICK = ("by turns, it stays", "240 ticks late", "runs in one tick of ten", "exchanged", "tare while")
ALL = more_attacks.CASES + shared_attacks.CASES


def test_a_few_stay_within_the_budget():
    few = [case for case in ALL if any(part in case.name for part in QUICK)]
    assert len(few) == len(QUICK) + 1
    assert max(travels(few))[0] < BUDGET


def test_reports_of_all_drives_may_be_lost_while_an_axis_goes_by_itself():
    """The tilt at its limit of 9 mm/s: told after six ticks, 212 um; after ten, as once, 348 um."""
    ((way, _),) = travels([case for case in attacks.CASES if "all reports lost" in case.name])
    assert 150e-6 < way < 250e-6


@pytest.mark.slow
def test_all_stay_within_the_budget():
    assert max(travels(ALL))[0] < BUDGET
