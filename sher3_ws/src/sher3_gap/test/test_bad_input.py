"""Bad input: a clear error that names the slip, or a stated narrower answer; never a wrong cause."""

from dataclasses import replace

import numpy as np
import pytest
import yaml
from sher3_bags import Stream, write_case
from sher3_common import Sher3Error
from sher3_description import Robot
from sher3_gap import diagnose_case
from sher3_gap.case.audit import audit
from sher3_gap.case.loading import load_case
from sher3_gap.errors import CaseError
from simulated import ROBOT, runs_of, signals

LOADS = runs_of(["loads"], repeats=1, duration=2.5)[0]


@pytest.fixture(scope="module")
def healthy():
    return runs_of(["sweep", "task"], repeats=2, duration=2.5)


def scaled(runs, topic, column, factor):
    """Return the runs with one column of a topic in another unit."""
    out = []
    for run in runs:
        stream = run.streams[topic]
        columns = {**stream.columns, column: np.asarray(stream.columns[column]) * factor}
        out.append(replace(run, streams={**run.streams, topic: replace(stream, columns=columns)}))
    return out


def test_a_good_case_has_nothing_to_note(healthy):
    assert audit(signals([*healthy, LOADS]), ROBOT) == []


@pytest.mark.parametrize(
    ("topic", "column", "factor", "words"),
    [
        ("measured_js", "position", 1e3, "measured_js position of delta_1 looks like mm for m"),
        ("drives/measured_js", "position", [1, 1, 1, 180 / np.pi, 1], "position of roll looks like deg for rad"),
        ("setpoint_js", "position", [1e3, 1e3, 1e3, 1, 1e3], "mm for m"),
        ("servo_jv", "velocity", 1e3, "servo_jv velocity of delta_1 looks like mm for m"),
        ("drives/setpoint_jv", "velocity", 1e6, "um for m"),
        ("drives/measured_js", "effort", 1e3, "looks like mN for N"),
        ("force/measured_cf", "torque", 1e3, "looks like N*mm for N*m"),
        ("tracker/measured_cp", "position", 1e3, "tracker/measured_cp position looks like mm for m"),
        ("temperature", "temperature", 295.0 / 22.0, "temperature looks like K for deg C"),
    ],
)
def test_unit_slips_are_named(topic, column, factor, words):
    with pytest.raises(CaseError, match="looks like") as caught:
        audit(signals(scaled([LOADS] if topic.startswith("force") else MOVING, topic, column, factor)), ROBOT)
    assert words in str(caught.value)


MOVING = runs_of(["postures"], repeats=1)


def test_missing_topics_narrow_the_answer(healthy):
    bare = [replace(r, streams={k: v for k, v in r.streams.items() if not k.startswith("tracker")}) for r in healthy]
    assert audit(signals(bare), ROBOT)[-1] == (
        "tracker/measured_cp was not recorded: mechanism and structure cannot be judged"
    )
    some = [bare[0], *healthy[1:]]
    assert "missing in 1 of 4 runs" in audit(signals(some), ROBOT)[-1]


def test_too_few_repeats_are_said(healthy):
    notes = audit(signals([healthy[0], healthy[2]]), ROBOT)
    assert any("no excitation was repeated" in n for n in notes)
    assert any("no intervals" in n for n in notes)
    assert any("nothing to hold out" in n for n in audit(signals(healthy[:1]), ROBOT))


def test_repeats_of_another_command_are_refused(healthy):
    other = replace(healthy[2], metadata=replace(healthy[2].metadata, excitation="sweep"))
    with pytest.raises(CaseError, match="other set-points"):
        audit(signals([healthy[0], other]), ROBOT)


def test_mixed_parameters_are_refused(healthy, tmp_path):
    other = yaml.safe_load(ROBOT.to_yaml())
    other["position_gain"] = 25.0
    mixed = replace(healthy[1], robot_yaml=Robot.from_yaml(yaml.safe_dump(other)).to_yaml())
    write_case(tmp_path / "case", [healthy[0], mixed], ROBOT)
    with pytest.raises(CaseError, match=r"other parameters.*position_gain 25\.0 instead of 20\.0"):
        load_case(tmp_path / "case")


def toleranced(**tolerances):
    return Robot.from_dict({**ROBOT.to_dict(), "tolerances": tolerances})


def test_a_table_of_tolerances_that_contradicts_itself_is_refused(healthy, tmp_path):
    other = replace(healthy[1], robot_yaml=toleranced(mass=0.03).to_yaml())
    write_case(tmp_path / "two", [healthy[0], other], toleranced(mass=0.02))
    with pytest.raises(CaseError, match=r"two tolerances\.mass.*0\.03.*0\.02"):
        load_case(tmp_path / "two")


def test_a_case_may_state_tolerances_that_its_runs_do_not(healthy, tmp_path):
    write_case(tmp_path / "one", healthy, toleranced(mass=0.02))
    assert load_case(tmp_path / "one")[1].tolerances.mass == 0.02


def stamps_changed(run, change):
    streams = {}
    for topic, s in run.streams.items():
        streams[topic] = Stream(s.type, change(s.stamp), s.frame_id, s.columns, s.log_time)
    return replace(run, streams=streams)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda t: np.where(np.arange(len(t)) > len(t) // 2, t - 10**9, t), "jumps back"),
        (lambda t: np.where(np.arange(len(t)) > len(t) // 2, t + 10**8, t), "ticks are missing"),
        (lambda t: t[0] + 2 * (t - t[0]), "tick period differs"),
    ],
)
def test_clock_jumps_are_refused(healthy, change, words):
    with pytest.raises(CaseError, match=words):
        signals([stamps_changed(healthy[0], change)])


@pytest.mark.parametrize(
    ("topic", "column"),
    [
        ("drives/measured_js", "position"),
        ("drives/measured_js", "effort"),
        ("drives/setpoint_jv", "velocity"),
        ("measured_js", "position"),
        ("force/measured_cf", "force"),
        ("force/measured_cf", "torque"),
        ("tracker/measured_cp", "position"),
        ("tracker/measured_cp", "orientation"),
    ],
)
def test_not_a_number_in_one_channel_alone_is_refused(healthy, topic, column):
    broken = np.array(healthy[0][topic].columns[column], copy=True)
    broken[17, 1] = np.nan
    columns = {**healthy[0][topic].columns, column: broken}
    run = replace(healthy[0], streams={**healthy[0].streams, topic: replace(healthy[0][topic], columns=columns)})
    with pytest.raises(CaseError, match=f"{topic}.*not a finite number in sample 17"):
        signals([run])


def test_a_cut_bag_is_refused_with_its_remedy(healthy, tmp_path):
    folder = write_case(tmp_path / "case", healthy, ROBOT)
    bag = next((folder / "run_01").glob("*.mcap"))
    bag.write_bytes(bag.read_bytes()[: bag.stat().st_size // 2])
    with pytest.raises(Sher3Error, match="recover"):
        diagnose_case(folder)
