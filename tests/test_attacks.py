"""Attacks that no list has, a few of those of `bench/more_attacks.py` and `bench/shared_attacks.py`."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "bench"))
import more_attacks
import shared_attacks
from attacks import Case, results

BUDGET = 40.0
"""Travel near tissue [um]."""
QUICK = ("by turns, it stays", "240 ticks late", "runs in one tick of ten", "exchanged", "tare while")
ALL = more_attacks.CASES + shared_attacks.CASES


def travels(cases: list[Case]) -> dict[str, float]:
    """The travel of each [um]."""
    return {line: float(line.split()[0]) for line in results(cases)}


def test_a_few_stay_within_the_budget():
    few = [case for case in ALL if any(part in case.name for part in QUICK)]
    assert len(few) == len(QUICK) + 1
    assert max(travels(few).values()) < BUDGET


@pytest.mark.slow
def test_all_stay_within_the_budget():
    assert max(travels(list(ALL)).values()) < BUDGET
