"""Files of a folder whose names differ in a word: runs of other lengths, or joints of one log."""

import numpy as np
import pytest
from sher3_machines.intake.runs import runs_of

WORDS = ("slow", "fast", "loaded")


def write(folder, stretches):
    for name, t in stretches.items():
        rows = np.column_stack([t, np.sin(t), np.cos(t)])
        np.savetxt(folder / f"{name}.csv", rows, delimiter=",", header="time,position,effort", comments="")


@pytest.mark.parametrize("seed", range(4))
def test_files_that_last_differently_are_runs(tmp_path, seed):
    rng = np.random.default_rng(seed)
    lengths = rng.permutation([200, 300, 450])
    period = rng.uniform(0.002, 0.02)
    write(tmp_path, {word: np.arange(n) * period for word, n in zip(WORDS, lengths, strict=True)})
    found = runs_of([tmp_path])
    assert {name: len(run["time"]) for name, run in found.items()} == dict(zip(WORDS, lengths, strict=True))


def test_files_of_one_length_at_other_times_are_runs(tmp_path):
    write(tmp_path, {word: 1.7e9 + 100.0 * i + np.arange(300) * 0.01 for i, word in enumerate(WORDS)})
    assert set(runs_of([tmp_path])) == set(WORDS)


@pytest.mark.parametrize("seed", range(4))
def test_joints_that_one_log_covers_are_no_runs(tmp_path, seed):
    rng = np.random.default_rng(seed)
    rates = rng.uniform(50.0, 500.0, 3)
    start = [1.7e9 + rng.uniform(0.0, 0.05) for _ in WORDS]
    joints = ("shoulder", "elbow", "wrist")
    write(tmp_path, {j: s + np.arange(0.0, 10.0, 1.0 / r) for j, s, r in zip(joints, start, rates, strict=True)})
    (run,) = runs_of([tmp_path]).values()
    assert {name.split("/")[0] for name in run} == set(joints)
