"""Tables whose columns nobody named: names that are given, and what the numbers alone tell."""

import numpy as np
import pytest
from scipy.io import savemat
from sher3_common import parse_yaml
from sher3_machines import MachineError
from sher3_machines.drafting.drafts import draft_of


def swing(seed):
    """Time, place, speed and a torque of drawn rate, length and motion."""
    draw = np.random.default_rng(seed)
    rate, f = draw.uniform(50.0, 1000.0), draw.uniform(0.3, 2.0, 2)
    t = np.arange(int(draw.uniform(10.0, 20.0) * rate)) / rate
    q = np.sin(2 * np.pi * f[0] * t) + 0.5 * np.cos(2 * np.pi * f[1] * t)
    v = 2 * np.pi * (f[0] * np.cos(2 * np.pi * f[0] * t) - 0.5 * f[1] * np.sin(2 * np.pi * f[1] * t))
    return np.column_stack([t, q, v, draw.normal(size=len(t))])


@pytest.mark.parametrize("seed", range(5))
def test_place_and_speed_are_told_by_the_motion_in_any_order(tmp_path, seed):
    order = np.random.default_rng(seed).permutation(4)
    np.savetxt(tmp_path / "a.csv", swing(seed)[:, order], delimiter=",")
    found = draft_of(tmp_path / "a.csv")
    column = {what: f"c{list(order).index(i)}" for i, what in enumerate(("time", "position", "velocity", "torque"))}
    described = parse_yaml(found.text)
    signals = described["axes"][0]["signals"]
    assert described["time"]["column"] == column["time"]
    assert {k: v["column"] for k, v in signals.items()} == {k: column[k] for k in ("position", "velocity")}
    assert f"not told by the motion: {column['torque']}" in found.text


@pytest.mark.parametrize("seed", range(4))
def test_titles_that_say_nothing_are_none_where_one_is_the_speed_of_another(tmp_path, seed):
    """As of a haptic device, in one letter each, or of a language that nobody here speaks; others keep their titles."""
    t, q, v, noise = swing(seed).T
    titles = [["t", "P", "V", "Fe"], ["czas", "kąt", "pochodna", "zakłócenie"]][seed % 2]
    tables = np.column_stack([t, q, v, noise])
    kept = np.random.default_rng(seed).permutation(4)
    head = ",".join([titles[i] for i in kept] + ["temperature"])
    np.savetxt(tmp_path / "a.csv", np.column_stack([tables[:, kept], noise]), delimiter=",", header=head, comments="")
    described = parse_yaml(draft_of(tmp_path / "a.csv").text)
    signals = described["axes"][0]["signals"]
    assert described["time"]["column"] == titles[0]
    assert [signals[k]["column"] for k in ("position", "velocity")] == titles[1:3]
    assert set(signals) == {"position", "velocity", "temperature"}


def test_titles_that_say_nothing_are_no_places_by_following_each_other(tmp_path):
    t = np.arange(2000) / 100.0
    level = np.sign(np.sin(t))
    late = np.concatenate([level[:30], level[:-30]])
    np.savetxt(tmp_path / "a.csv", np.column_stack([t, level, late]), delimiter=",", header="t,ch1,ch2", comments="")
    with pytest.raises(MachineError, match="levels and temperatures are no machine"):
        draft_of(tmp_path / "a.csv")


@pytest.mark.parametrize("seed", range(4))
def test_what_balances_the_motion_is_the_effort_in_each_table_of_a_folder(tmp_path, seed):
    draw = np.random.default_rng(seed)
    for joint in ("hip", "knee"):
        _, q, v, noise = swing(seed).T
        force = draw.uniform(0.0, 0.3) * np.gradient(v) * 200.0 + draw.uniform(1.0, 5.0) * v + 3.0 * np.sin(q)
        order = draw.permutation(3)
        columns = np.column_stack([q, v, force + draw.uniform(0.5, 2.0) * np.sign(v) + 0.2 * noise])
        np.savetxt(tmp_path / f"{joint}.csv", columns[:, order], delimiter=",")
        np.savetxt(tmp_path / f"{joint}.order", order)
    rate = float(1.0 / swing(seed)[1, 0])
    for axis in parse_yaml(draft_of(tmp_path, rate=rate).text)["axes"]:
        order = list(np.loadtxt(tmp_path / f"{axis['name']}.order"))
        read = {k: axis["signals"][k]["column"] for k in ("position", "velocity", "effort")}
        assert read == {k: f"{axis['name']}/c{order.index(i)}" for i, k in enumerate(read)}


@pytest.mark.parametrize("joints", [2, 3, 6])
def test_places_with_speeds_and_forces_of_several_joints_are_blocks_without_a_model(tmp_path, joints):
    rows = min(len(swing(seed)) for seed in range(joints))
    t = np.arange(rows) / 200.0
    draw = np.random.default_rng(joints)
    q = np.column_stack([np.sin(f * t + p) for f, p in draw.uniform(0.5, 6.0, (joints, 2))])
    q[:, -1] = 0.4 if joints > 2 else q[:, -1]  # held
    v = np.gradient(q, t, axis=0)
    force = v + 0.5 * np.sign(v) + np.sin(q) + draw.normal(0.0, 0.1, q.shape)
    np.savetxt(tmp_path / "robot.csv", np.column_stack([t, q, v, force]), delimiter=",")
    for axis in parse_yaml(draft_of(tmp_path / "robot.csv").text)["axes"]:
        first = int(axis["name"].removeprefix("joint"))
        read = {k: axis["signals"][k]["column"] for k in ("position", "velocity", "effort")}
        assert read == {k: f"c{first + i * joints}" for i, k in enumerate(read)}


def test_a_file_for_each_signal_has_its_name(tmp_path):
    t = np.arange(0.0, 10.0, 0.01)
    for name, x in {"x": np.sin(t), "F": np.sign(np.cos(t))}.items():
        np.save(tmp_path / f"{name}.npy", x)
    signals = parse_yaml(draft_of(tmp_path, rate=100.0).text)["axes"][0]["signals"]
    assert {k: signals[k]["column"] for k in signals} == {"position": "x/array", "effort": "F/array"}


def test_a_matrix_is_a_table_too(tmp_path):
    savemat(tmp_path / "a.mat", {"data": swing(1), "J": 0.2})
    described = parse_yaml(draft_of(tmp_path / "a.mat").text)
    signals = described["axes"][0]["signals"]
    assert (described["time"]["column"], described["time"]["index"]) == ("data", 0)
    assert (signals["position"]["column"], signals["position"]["index"]) == ("data", 1)


def followed(seed, gain=1.0):
    """Time, a reference in steps or a chirp, and what follows it late, of drawn rate, lag and sense."""
    draw = np.random.default_rng(seed)
    rate, lag = draw.uniform(50.0, 500.0), draw.uniform(0.03, 0.08)
    t = np.arange(int(draw.uniform(8.0, 30.0) * rate)) / rate
    levels = draw.uniform(-1.0, 1.0, int(t[-1]) + 2)[t.astype(int)]
    asked = levels if seed % 2 else np.sin(2.0 * t + 0.1 * t**2)
    place = np.interp(t - lag, t, asked) * draw.choice([-1.0, 1.0]) * gain
    return np.column_stack([t, asked, np.round(place + draw.normal(0.0, 0.003, len(t)), 3)])


@pytest.mark.parametrize("seed", range(6))
def test_a_place_is_what_follows_another_column_late_and_as_far(tmp_path, seed):
    order = np.random.default_rng(seed).permutation(3)
    np.savetxt(tmp_path / "a.csv", followed(seed)[:, order], delimiter=",")
    signals = parse_yaml(draft_of(tmp_path / "a.csv").text)["axes"][0]["signals"]
    column = {what: f"c{list(order).index(i)}" for i, what in enumerate(("time", "reference", "position"))}
    assert {k: signals[k]["column"] for k in signals} == {k: column[k] for k in ("position", "reference")}
    np.savetxt(tmp_path / "b.csv", followed(seed, 3.0)[:, order], delimiter=",")
    with pytest.raises(MachineError, match="--names"):
        draft_of(tmp_path / "b.csv")


@pytest.mark.parametrize("order", [(0, 1, 2, 3, 4), (0, 2, 1, 4, 3), (0, 1, 3, 2, 4)])
def test_a_place_its_reference_and_their_speeds_are_one_axis_and_no_two_joints(tmp_path, order):
    t = np.arange(0.0, 20.0, 0.005)
    asked, lag = np.sin(2.0 * t + 0.1 * t**2), 0.05
    place = np.interp(t - lag, t, asked) + np.random.default_rng(0).normal(0.0, 1e-4, len(t))
    rows = np.column_stack([t, place, asked, np.gradient(place, t), np.gradient(asked, t)])
    np.savetxt(tmp_path / "a.csv", rows[:, order], delimiter=",")
    (axis,) = parse_yaml(draft_of(tmp_path / "a.csv").text)["axes"]
    read = {k: axis["signals"][k]["column"] for k in ("position", "velocity", "reference")}
    assert read == {
        "position": f"c{order.index(1)}",
        "velocity": f"c{order.index(3)}",
        "reference": f"c{order.index(2)}",
    }


def test_a_number_of_the_sample_is_no_time_beside_one(tmp_path):
    found = followed(0)
    np.savetxt(tmp_path / "a.csv", np.column_stack([np.arange(len(found)), found]), delimiter=",")
    described = parse_yaml(draft_of(tmp_path / "a.csv").text)
    assert described["time"]["column"] == "c1"
    assert described["axes"][0]["signals"]["position"]["column"] == "c3"


@pytest.mark.parametrize("seed", range(3))
def test_a_column_alone_is_a_place_where_it_swings_to_rest(tmp_path, seed):
    draw = np.random.default_rng(seed)
    t = np.arange(0.0, 10.0, 0.01)
    fades = np.exp(-t * draw.uniform(0.3, 0.8))
    swing = fades * np.cos(draw.uniform(4.0, 12.0) * t + draw.uniform(0.0, 6.0))
    for name, x in {"swing": swing, "oven": fades}.items():
        read = 20.0 + x + draw.normal(0.0, 0.002, len(t))
        np.savetxt(tmp_path / f"{name}.csv", np.column_stack([t, read]), delimiter=",")
    described = parse_yaml(draft_of(tmp_path / "swing.csv").text)
    assert described["axes"][0]["signals"]["position"]["column"] == "c1"
    with pytest.raises(MachineError, match="--names"):
        draft_of(tmp_path / "oven.csv")


def test_given_names_are_in_the_words_of_the_file(tmp_path):
    np.savetxt(tmp_path / "a.csv", swing(2)[:, 1:], delimiter=",")
    described = parse_yaml(draft_of(tmp_path / "a.csv", rate=100.0, names=["q", "", "tau"]).text)
    signals = described["axes"][0]["signals"]
    assert {k: v["column"] for k, v in signals.items()} == {"position": "c0", "effort": "c2"}


def test_a_given_name_keeps_the_unit_of_its_column(tmp_path):
    header = {"header": "time [ms],loop [mm],read [mm]", "comments": ""}
    np.savetxt(tmp_path / "a.csv", swing(2)[:, :3], delimiter=",", **header)
    described = parse_yaml(draft_of(tmp_path / "a.csv", names=["t", "reference", "position [um]"]).text)
    signals = described["axes"][0]["signals"]
    assert described["time"] == {"column": "time [ms]", "unit": "ms"}
    assert signals["position"].items() >= {"column": "read [mm]", "unit": "um"}.items()
    assert signals["reference"] == {"column": "loop [mm]", "unit": "mm"}


@pytest.mark.parametrize("names", [["t", "q"], ["t", "q", "q", "tau"]])
def test_names_that_do_not_fit_are_refused_with_the_columns(tmp_path, names):
    np.savetxt(tmp_path / "a.csv", swing(3), delimiter=",")
    with pytest.raises(MachineError, match="names do not fit the columns") as refused:
        draft_of(tmp_path / "a.csv", names=names)
    assert "c0, c1, c2, c3" in str(refused.value)


def test_columns_of_which_nothing_is_told_are_refused_with_a_remedy(tmp_path):
    np.savetxt(tmp_path / "a.csv", np.random.default_rng(0).normal(size=(99, 2)), delimiter=",")
    with pytest.raises(MachineError, match="--names"):
        draft_of(tmp_path / "a.csv", rate=10.0)


def test_what_parts_cells_at_the_end_of_a_line_makes_no_column(tmp_path):
    lines = ["\t".join(f"{x:.6f}" for x in row) for row in swing(3)]
    (tmp_path / "a.dat").write_text("\t\n".join([*lines, ""]))
    with pytest.raises(MachineError, match="names do not fit") as refused:
        draft_of(tmp_path / "a.dat", names=["q"])
    assert "4 different ones" in str(refused.value)


def test_a_short_table_of_readings_can_be_named(tmp_path):
    load = np.arange(1.0, 9.0)
    np.savetxt(
        tmp_path / "a.csv", np.column_stack([load, 3.0 * load, 0.0 * load]), delimiter=",", header="M,d,e", comments=""
    )
    described = parse_yaml(draft_of(tmp_path / "a.csv", names=("weight_kg", "reading", "")).text)
    assert described["kind"] == "load_cell"
    assert (described["applied"]["column"], described["reading"]["column"]) == ("M", "d")


@pytest.mark.parametrize("centre", [(0.0, 0.0), (0.3, -0.2)])
def test_a_point_on_a_circle_is_no_place_and_its_speed(tmp_path, centre):
    """A joint that is turned before a tracker: each coordinate follows the slope of the other one."""
    t = np.arange(400) * 0.05
    turn = np.pi * (1.0 - np.cos(np.pi * t / t[-1])) / 2.0
    rows = np.column_stack([t, 0.5 * np.sin(turn) + centre[0], -0.5 * np.cos(turn) + centre[1], np.full_like(t, 0.8)])
    np.savetxt(tmp_path / "a.csv", rows, delimiter=",")
    with pytest.raises(MachineError, match="looks like a position"):
        draft_of(tmp_path / "a.csv")


def test_u_and_y_of_one_part_of_a_record_are_what_drives_and_what_comes_out(tmp_path):
    t, q = swing(0)[:, 0], np.column_stack([swing(0)[:, 1], swing(0)[:, 2]])
    parts = {"train": slice(None), "test": slice(200)}
    arrays = {f"{k}_{n}": x[s].T for n, s in parts.items() for k, x in (("u", np.sign(q)), ("y", q))}
    savemat(tmp_path / "a.mat", arrays | {f"time_{n}": t[s][None] for n, s in parts.items()})
    axes = parse_yaml(draft_of(tmp_path / "a.mat").text)["axes"]
    assert [[axis["signals"][k]["column"] for k in ("position", "command")] for axis in axes] == [
        ["y_train", "u_train"]
    ] * 2


def test_joints_that_go_one_way_and_back_do_not_follow_each_other(tmp_path):
    """What is late after it all the same is refused with its time, and with how to name the rest."""
    t = np.arange(300) / 100.0
    q = [np.sin(1.5 * t - 0.1 * i) for i in range(2)]
    np.savetxt(tmp_path / "a.csv", np.column_stack([t, *q]), delimiter=",")
    with pytest.raises(MachineError, match=r"c0 is the time; name the columns in order"):
        draft_of(tmp_path / "a.csv")


@pytest.mark.parametrize("seed", range(4))
def test_stamps_that_are_read_to_a_coarse_tick_are_a_clock_in_a_matrix(tmp_path, seed):
    """As of a logger that reads hundredths of a second about every 20 ms."""
    draw = np.random.default_rng(seed)
    t = np.cumsum(draw.uniform(0.016, 0.025, 2000))
    place = 1.25 + 0.2 * draw.normal(size=len(t))
    savemat(tmp_path / "a.mat", {"data": np.column_stack([t.round(2), place, place / 51.0])})
    with pytest.raises(MachineError, match=r"data\[0\] is the time"):
        draft_of(tmp_path / "a.mat")
