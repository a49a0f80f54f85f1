"""Records with more readings than an answer needs."""

import numpy as np
import pytest
from sher3_machines.intake.mending.stretches import STRETCHES, spread

FAST, SLOW = np.arange(100_000) * 1e-3, np.arange(10_000) * 1e-2
TABLES = {"a/time": FAST, "a/q": FAST**2, "b/time": SLOW, "b/u": SLOW + 1.0, "other": np.arange(7)}
STAMPS = {"a/time": FAST, "a/q": FAST, "b/time": SLOW, "b/u": SLOW}


def test_a_record_that_is_no_longer_than_needed_stays_whole():
    assert spread("run", TABLES, STAMPS, 100_000) == ({"run": TABLES}, "")


def test_of_a_longer_one_stretches_are_taken_at_the_same_time_in_every_table():
    parts, note = spread("run", TABLES, STAMPS, 24_000)
    assert len(parts) == STRETCHES and "run.part1: run has 100000 rows" in note and "24% of it" in note
    assert sum(len(x["a/q"]) for x in parts.values()) == pytest.approx(24_000, abs=STRETCHES)
    for part in parts.values():
        assert (part["a/q"] == part["a/time"] ** 2).all() and len(part["other"]) == 7
        assert part["a/time"][[0, -1]] == pytest.approx(part["b/time"][[0, -1]], abs=0.02)
    first, *_, last = parts.values()
    assert first["a/time"][0] == 0.0 and last["a/time"][-1] > 99.9
