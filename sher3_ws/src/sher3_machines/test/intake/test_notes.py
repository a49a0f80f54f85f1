"""Notes that say the same of several runs are told once."""

from sher3_machines.intake.notes import merged


def test_the_same_of_several_runs_is_told_once():
    notes = ["a: 3 stamps are there twice", "floors: none", "b: 3 stamps are there twice", "b: turned"]
    assert merged(notes, ["a", "b"]) == ["a, b: 3 stamps are there twice", "floors: none", "b: turned"]


def test_numbers_that_differ_are_those_of_the_first_run():
    notes = [f"r{i}: {i + 2} readings are off by {0.5 * i:.1f} rad" for i in range(34)]
    (told,) = merged(notes, [f"r{i}" for i in range(34)])
    assert told.startswith("r0, r1, r2 and 31 more: 2 readings are off by 0.0 rad (numbers of r0")


def test_notes_on_no_run_stay_apart():
    assert merged(["joint 1: lag 3 ms", "joint 1: lag 4 ms"], ["a"]) == ["joint 1: lag 3 ms", "joint 1: lag 4 ms"]


def test_names_with_numbers_are_no_numbers():
    notes = ["a: joint1.effort is off in 3% of the samples", "a: joint2.effort is off in 3% of the samples"]
    assert merged(notes, ["a", "b"]) == notes
