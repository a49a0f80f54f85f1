"""Files of a folder whose names differ in a word: runs of other lengths, or joints of one log."""

import numpy as np
import pytest
from sher3_common import parse_yaml
from sher3_machines.drafting.drafts import draft_of
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


@pytest.mark.parametrize("name", ["motor_data_{}_volts", "{}kg", "sweep-{}.5Hz-up"])
def test_files_that_are_named_by_what_was_set_are_runs_and_what_was_set_drives(tmp_path, name):
    """Each run has one voltage, so that none of them shows that it changes."""
    t = np.arange(300) * 0.01
    for level in (3, 6, 12):
        rows = np.column_stack([t, np.full_like(t, level), 50.0 * level * (1.0 - np.exp(-t / 0.1))])
        path = tmp_path / f"{name.format(level)}.csv"
        np.savetxt(path, rows, delimiter=",", header="Time (s),Voltage (V),Speed (rad/s)", comments="")
    assert len(runs_of([tmp_path])) == 3
    (axis,) = parse_yaml(draft_of(tmp_path).text)["axes"]
    assert axis["signals"]["command"]["column"] == "Voltage (V)" and axis["command_law"]["kind"] == "force"


def test_runs_may_end_a_few_hundredths_apart_and_joints_too(tmp_path):
    stretches = {f"step_duty_0.{n}": np.arange(900 + 20 * n) * 0.006 for n in (5, 6, 8)}
    write(tmp_path, stretches)
    assert set(runs_of([tmp_path])) == set(stretches)
    joints = tmp_path / "joints"
    joints.mkdir()
    write(joints, {f"joint_{n}_rad": np.arange(900 + 20 * n) * 0.006 for n in (5, 6, 8)})
    assert len(runs_of([joints])) == 1
