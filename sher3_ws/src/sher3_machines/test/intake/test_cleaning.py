"""Small faults of logs: each is mended in the one way that is right, or refused."""

import numpy as np
import pytest
from sher3_machines import MachineError
from sher3_machines.intake.mending.parts import MOST, cut
from sher3_machines.intake.mending.readings import glitches, known_readings, longest_run
from sher3_machines.intake.mending.stamps import even_stamps

TIME = 0.01 * np.arange(200)


def test_stamps_that_are_right_stay():
    stamps, kept, note = even_stamps(TIME, "run")
    assert (stamps == TIME).all() and len(kept) == 200 and note == ""


def test_a_sample_written_twice_counts_once():
    doubled = np.insert(TIME, 50, TIME[50])
    stamps, kept, note = even_stamps(doubled, "run")
    assert (stamps == TIME).all() and 51 not in kept and "1 stamps are there twice" in note


def test_rounded_stamps_lie_on_their_line():
    stamps, _, note = even_stamps(np.floor(TIME / 0.04) * 0.04, "run")
    assert np.diff(stamps) == pytest.approx(0.01, rel=0.05) and "rounded to 0.04 s" in note


@pytest.mark.parametrize("rows", [2, 5, 9])
def test_of_each_tick_of_a_clock_slower_than_its_log_one_row_is_a_sample(rows):
    """A logger that runs as fast as it can writes one to ten rows for each tick of 25 ms."""
    ticks = np.arange(200) * 0.025
    stamps, kept, note = even_stamps(np.repeat(ticks, np.random.default_rng(rows).integers(1, 2 * rows, 200)), "run")
    assert (stamps == ticks).all() and len(kept) == 200 and "of each of its 200 ticks" in note


def test_stamps_that_are_no_line_are_refused():
    with pytest.raises(MachineError, match="repeat the one before"):
        even_stamps(np.repeat(np.cumsum(np.random.default_rng(1).exponential(size=50)), 3), "run")
    with pytest.raises(MachineError, match="does not increase"):
        even_stamps(np.zeros(50), "run")


def test_samples_in_a_wrong_order_are_sorted():
    mixed = TIME.copy()
    mixed[[20, 21]] = mixed[[21, 20]]
    stamps, kept, note = even_stamps(mixed, "run")
    assert (stamps == TIME).all() and list(kept[20:22]) == [21, 20] and "wrong order" in note


def test_missing_readings_are_few_or_refused():
    x = np.sin(TIME)
    x[5:8] = np.nan
    known, note = known_readings(x, False, "run: q")
    assert known.sum() == 197 and "3 of 200" in note
    x[5:40] = np.nan
    assert known_readings(x, True, "run: q")[0].sum() == 165  # with stamps a hole is judged by its length in time
    with pytest.raises(MachineError, match="35 in a row"):
        known_readings(x, False, "run: q")


def test_a_glitch_stands_alone_and_a_step_does_not():
    x = np.sin(0.01 * np.arange(1000))
    x[60], x[130] = 7.0, -9e9
    assert list(glitches(x)) == [60, 130]
    assert not len(glitches(np.where(TIME > 1.0, 1.0, 0.0) + 0.01 * np.sin(9.0 * TIME)))
    assert not len(glitches(np.random.default_rng(0).normal(size=500)))
    short = np.sin(0.05 * np.arange(150))
    short[[40, 80, 120]] += 9.0
    assert list(glitches(short)) == [40, 80, 120]


def test_a_log_is_cut_where_its_clock_has_a_hole_or_jumps_back():
    time = np.r_[TIME, 30.0 + TIME, TIME]
    parts, note = cut("log", {"t": time, "q": np.arange(600.0), "matrix": np.eye(3)}, "t")
    assert [len(x["q"]) for x in parts.values()] == [200, 200, 200] and parts["log.part2"]["q"][0] == 200.0
    assert all(x["matrix"].shape == (3, 3) for x in parts.values()) and "jumps back" in note
    assert cut("log", {"t": TIME}, "t") == ({"log": {"t": TIME}}, "")


def test_the_longest_run_of_a_mask():
    assert longest_run(np.array([True, True, False, True, True, True])) == 3
    assert longest_run(np.zeros(4, dtype=bool)) == 0


def test_of_very_many_parts_the_longest_are_judged():
    """A log of 66 holes is one of 67 records, of which 50 are judged; where the clock is nothing but holes, none."""
    time = 0.01 * np.arange(6700.0) + np.repeat(np.arange(67.0), 100)
    parts, note = cut("log", {"t": time}, "t")
    assert len(parts) == MOST and "cut into 50 parts" in note and "1700 samples are in none of them" in note
    assert len(cut("log", {"t": np.repeat(time, 10)[::7] + 10.0 * np.arange(len(time) * 10 // 7 + 1)}, "t")[0]) == 1


@pytest.mark.parametrize("end", [1000.0, 60000.0, 65536.0])
def test_a_clock_that_starts_again_is_counted_on(end):
    """Milliseconds of a second or of a minute, or 16 bits of them; a command steps as the clock starts again."""
    time = 4.0 + 2.0 * np.arange(int(1.3 * end))
    place, command = np.cumsum(np.cos(0.05 * time)), np.sign(np.floor(time / end) - 0.5)
    parts, note = cut("run", {"t": time % end, "q": place, "u": command}, "t")
    assert list(parts) == ["run"] and parts["run"]["t"] == pytest.approx(time)
    assert f"its clock starts again after {end:g}" in note


def test_runs_that_start_again_stay_runs_though_each_is_as_long_as_a_clock_counts():
    time = np.arange(0.0, 10.0, 0.02)
    answer = 1.0 - np.exp(-time)
    parts, note = cut("run", {"t": np.tile(time, 3), "q": np.tile(answer, 3)}, "t")
    assert len(parts) == 3 and "jumps back" in note


@pytest.mark.parametrize("rows", [4, 5, 12])
def test_samples_that_arrive_in_bunches_are_even(rows):
    """A port hands over several samples at once: each is stamped as it arrives, 0.2 ms after the one before."""
    sample = np.arange(400)
    arrived = 0.01 * rows * (sample // rows + 1) + 2e-4 * (sample % rows)
    jitter = np.repeat(np.random.default_rng(rows).uniform(0.0, 5e-3, 400 // rows + 1), rows)[:400]
    stamps, kept, note = even_stamps(arrived + jitter, "run")
    assert len(kept) == 400 and np.diff(stamps) == pytest.approx(0.01, rel=0.03) and "in bunches" in note


def test_a_log_with_a_hole_or_pauses_is_no_log_in_bunches():
    for stamps in (np.concatenate([TIME, 50.0 + TIME]), np.concatenate([TIME[:20] + 5.0 * k for k in range(6)])):
        assert "bunches" not in even_stamps(stamps, "run")[2]
