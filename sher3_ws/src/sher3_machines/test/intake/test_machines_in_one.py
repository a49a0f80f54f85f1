"""Tables in which a column of text says of which machine each row is."""

import numpy as np
import pytest
from sher3_common import parse_yaml
from sher3_machines import import_case, open_case
from sher3_machines.drafting.drafts import draft_of
from sher3_machines.intake.tables import read_tables

T = np.arange(0.0, 6.0, 0.02)
MOTORS = "ABCD"


def rows_of(name, k, stamps):
    duty = 60.0 * np.sign(np.sin(0.7 * stamps + k))
    speed = np.convolve(1.5 * duty, np.exp(-stamps / 0.15) * 0.02 / 0.15)[: len(stamps)]
    speed += 0.3 * np.random.default_rng(k).normal(size=len(stamps))
    return [f"{t:.2f},{name},{u:.0f},{w:.2f}" for t, u, w in zip(stamps, duty, speed, strict=True)]


def written(tmp_path, rows, header="time_s,motor,pwm,speed_rpm"):
    (tmp_path / "a.csv").write_text("\n".join([header, *rows]))
    return tmp_path / "a.csv"


@pytest.mark.parametrize("turns", [True, False], ids=["by turns", "one below the other"])
@pytest.mark.parametrize("late", [0.0, 0.1])
def test_each_machine_is_an_axis_by_itself(tmp_path, turns, late):
    """Whatever the letter says elsewhere: `D` is a motor here and no demand; one may begin 0.1 s after another."""
    each = [rows_of(name, k, T + late * k / 3.0) for k, name in enumerate(MOTORS)]
    path = written(tmp_path, [row for part in (zip(*each, strict=True) if turns else each) for row in part])
    found = draft_of(path)
    axes = parse_yaml(found.text)["axes"]
    assert [axis["signals"]["position"]["column"] for axis in axes] == [f"{name}/speed_rpm" for name in MOTORS]
    assert [axis["signals"]["command"]["column"] for axis in axes] == [f"{name}/pwm" for name in MOTORS]
    (tmp_path / "a.yaml").write_text(found.text)
    import_case([path], tmp_path / "a.yaml", tmp_path / "case")
    (run,) = open_case(tmp_path / "case")[1]
    assert set(run.signals) == {"a", "b", "c", "d"} and run.period == pytest.approx(0.02)


def test_a_state_is_no_machine(tmp_path):
    """Its stamps run on from one state to the next, or the log was begun again with the same states."""
    half = len(T) // 2
    once = rows_of("up", 0, T[:half]) + rows_of("down", 0, T[half:])
    for rows in (once, once + once):
        assert set(read_tables(written(tmp_path, rows))) == {"time_s", "pwm", "speed_rpm"}


def test_runs_that_last_unlike_are_no_machines(tmp_path):
    rows = rows_of("slow", 0, T) + rows_of("fast", 1, T[:200])
    assert set(read_tables(written(tmp_path, rows))) == {"time_s", "pwm", "speed_rpm"}
