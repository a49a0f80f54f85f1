"""Records with more readings than an answer needs."""

import numpy as np
import pytest
from sher3_machines.intake.mending.stretches import FEWEST, MOST_READINGS, STRETCHES, beginning, repeats_judged, spread

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


def test_of_many_repeats_as_many_as_an_answer_needs_are_judged_whole():
    repeats = {f"run{i}": {"q": np.zeros(1000)} for i in range(30)}
    assert repeats_judged(repeats, 2) == (repeats, "")
    kept, note = repeats_judged(repeats, MOST_READINGS // 10_000)
    assert len(kept) == 10 and next(iter(kept)) == "run0" and list(kept)[-1] == "run29" and "10 of them" in note
    assert all(kept[name] is repeats[name] for name in kept)
    assert len(repeats_judged(repeats, MOST_READINGS)[0]) == FEWEST


def test_of_a_repeat_that_is_too_long_the_beginning_is_taken():
    assert beginning("run", TABLES, STAMPS, 100_000) == (TABLES, "")
    found, note = beginning("run", TABLES, STAMPS, 25_000)
    assert len(found["a/q"]) == pytest.approx(25_000, abs=5) and len(found["other"]) == 7
    assert found["a/time"][0] == found["b/time"][0] == 0.0 and "first 25%" in note
