"""Episodes of a drawn servo in LeRobot's format: two joints, one late and rubbing, the other as told."""

import json
import os
import sys
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
import sher3.gap as gap
from data_sets import write_data_set
from sher3_machines import MachineError

RATE, SAMPLES = 50.0, 900
SHARED = Path(os.environ.get("SHER3_SHARED", Path(__file__).parents[4].parent / "shared"))
SAGE = SHARED / "real/sage_so101/output/real/so101/custom"


def episode(seed, late=4, missing=()):
    """Degrees: `lift` is four periods (80 ms) late, `pan` follows; encoders of 4096 counts."""
    t = np.arange(SAMPLES) / RATE
    rng = np.random.default_rng(seed)
    waves = [
        sum(a * np.sin(w * t + p) for a, w, p in rng.uniform([3, 0.5, 0], [15, 4.0, 6.0], (4, 3))) for _ in range(2)
    ]
    action = np.column_stack(waves)
    state = action.copy()
    state[late:, 1] = action[: len(action) - late, 1]
    state[:late, 1] = action[0, 1]
    count = 360.0 / 4096.0
    kept = np.setdiff1d(np.arange(SAMPLES), missing)
    return (t[kept] if len(missing) else None), action[kept], np.round(state[kept] / count) * count


@pytest.mark.parametrize("version", ["v2.1", "v3.0"])
def test_a_late_joint_is_found_in_both_versions(tmp_path, version):
    folder = write_data_set(tmp_path / "set", version, RATE, ["pan", "lift"], [episode(0), episode(1)])
    answer = gap.from_lerobot(folder)
    assert {c.actuator for c in answer.causes} == {"lift"}
    (cause,) = [c for c in answer.causes if c.family == "timing"]
    (size,) = [p.value for n, p in cause.parameters.items() if "delay" in n or "time" in n or "lag" in n]
    assert size == pytest.approx(0.08, rel=0.05)
    assert any("frame's number over 50 Hz" in note for note in answer.notes)
    assert any("states are in deg, because values reach" in guess for guess in answer.guessed)


@pytest.mark.parametrize("names", [[["pan", "lift"]], {"left": ["pan"], "right": ["lift"]}])
def test_names_in_lists_of_their_own_are_read(tmp_path, names):
    """As a humanoid's, whose arms and hands are lists in a list."""
    folder = write_data_set(tmp_path / "set", "v2.1", RATE, ["pan", "lift"], [episode(0), episode(1)])
    info = json.loads((folder / "meta/info.json").read_text())
    for feature in ("action", "observation.state"):
        info["features"][feature]["names"] = names
    (folder / "meta/info.json").write_text(json.dumps(info))
    assert {c.actuator for c in gap.from_lerobot(folder).causes} == {"lift"}


def test_a_column_for_each_joint_is_read_like_a_list(tmp_path):
    """As `observation.state.lift.pos`; actions stay a list in the second set."""
    for number, flat in enumerate((("observation.state", "action"), ("observation.state",))):
        given = [episode(0), episode(1)]
        folder = write_data_set(tmp_path / f"set{number}", "v3.0", RATE, ["pan", "lift"], given, flat=flat)
        answer = gap.from_lerobot(folder)
        assert {(c.family, c.actuator) for c in answer.causes} == {("timing", "lift")}


def test_features_are_read_as_libraries_of_policies_name_them(tmp_path):
    """`state` and `actions`, in `meta/info.json` and in the files."""
    folder = write_data_set(tmp_path / "set", "v2.1", RATE, ["pan", "lift"], [episode(0), episode(1)])
    named = {"observation.state": "state", "action": "actions"}
    info = json.loads((folder / "meta/info.json").read_text())
    info["features"] = {named.get(name, name): x for name, x in info["features"].items()}
    (folder / "meta/info.json").write_text(json.dumps(info))
    for file in folder.rglob("*.parquet"):
        table = pq.read_table(file)
        pq.write_table(table.rename_columns([named.get(name, name) for name in table.column_names]), file)
    assert {(c.family, c.actuator) for c in gap.from_lerobot(folder).causes} == {("timing", "lift")}


def test_periods_that_a_clock_missed_are_named_with_their_size(tmp_path):
    """One period at two places, and three in a row at a third."""
    folder = write_data_set(
        tmp_path / "set", "v3.0", RATE, ["pan", "lift"], [episode(0, missing=(100, 400, 600, 601, 602))]
    )
    answer = gap.from_lerobot(folder, unit="deg")
    notes = " ".join(answer.notes)
    assert "missed 5 periods of 20 ms at 3 places, 3 (60 ms) at most" in notes and "frame's number" not in notes
    assert {c.actuator for c in answer.causes} == {"lift", "all"}
    share, longest = (answer.causes[-1].parameters[n].value for n in ("probability", "longest"))
    assert (answer.causes[-1].effect, share, longest) == ("dropped_commands", 5 / 899, pytest.approx(0.06))
    assert answer.places[-1].gap == pytest.approx(0.02 * np.sqrt((1 + 1 + 9) / 894), rel=1e-3)
    assert "dropped commands" in answer.headline and "ropped commands" in answer.report()
    assert str(answer.corrected()) and answer.to_rows()[-1]["place"] == "all"


def test_missed_periods_are_the_cause_of_servos_that_do_as_they_are_told(tmp_path):
    given = [episode(0, late=0, missing=(100,)), episode(1, late=0, missing=(7, 8))]
    folder = write_data_set(tmp_path / "set", "v3.0", RATE, ["pan", "lift"], given)
    assert gap.from_lerobot(folder, unit="deg", without=["dropped_commands"]).status == "no_gap"
    answer = gap.from_lerobot(folder, unit="deg")
    assert (answer.status, [c.effect for c in answer.causes]) == ("attributed", ["dropped_commands"])
    assert "all axes: 1.06 ms rms over a floor of" in answer.where()[0]  # 20 ms times the root of (1 + 4) / 1795


def broken(tmp_path, **info):
    folder = write_data_set(tmp_path / "set", "v3.0", RATE, ["pan", "lift"], [episode(0)])
    known = json.loads((folder / "meta/info.json").read_text())
    (folder / "meta/info.json").write_text(json.dumps({**known, **info}))
    return folder


@pytest.mark.parametrize(
    ("info", "said"),
    [
        ({"codebase_version": "v1.6"}, r"version is not read; value v1\.6; limit v2\.0, v2\.1, v3; convert it"),
        (
            {"features": {"action": {"shape": [2], "names": None}}},
            r"no feature 'observation\.state'; limit features: action",
        ),
        ({"fps": 0}, r"`features` or `fps` is missing"),
    ],
)
def test_a_data_set_that_cannot_be_used_says_why(tmp_path, info, said):
    with pytest.raises(MachineError, match=said):
        gap.from_lerobot(broken(tmp_path, **info))


def test_what_is_no_data_set_is_named(tmp_path, monkeypatch):
    with pytest.raises(MachineError, match=r"is no LeRobot data set; limit a folder with meta/info\.json"):
        gap.from_lerobot(tmp_path)
    with pytest.raises(gap.InputError, match=r"unit of the joints is not known; value turns; limit rad, deg"):
        gap.from_lerobot(tmp_path, unit="turns")
    folder = broken(tmp_path)
    with pytest.raises(MachineError, match=r"no such episode; value \[7\]; limit 0 to 0"):
        gap.from_lerobot(folder, episodes=[0, 7])
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)
    with pytest.raises(MachineError, match=r"install sher3\[lerobot\]"):
        gap.from_lerobot(folder)


@pytest.mark.shared
@pytest.mark.skipif(not SAGE.is_dir(), reason=f"no data sets in {SAGE}")
def test_the_so101_in_this_form_is_told_as_from_its_own_files(tmp_path):
    """Weight on Pitch and Elbow, late servos, stiction; no backlash: as `test_real.py` has it of the CSV files."""
    from sher3_machines.intake.tables import read_tables

    episodes = []
    for motion in sorted(SAGE.iterdir()):
        x = read_tables(motion)
        n = min(len(x["control/timestamp"]), len(x["state_motor/timestamp"]))
        stamps = 1e-6 * (x["state_motor/timestamp"][:n] - x["state_motor/timestamp"][0])
        episodes.append((stamps, x["control/positions"][:n], x["state_motor/positions"][:n]))
    joints = ["Rotation", "Pitch", "Elbow", "Wrist_Pitch", "Wrist_Roll", "Jaw"]
    answer = gap.from_lerobot(write_data_set(tmp_path / "set", "v3.0", 49.85, joints, episodes), unit="rad")
    found = {(c.effect, c.actuator.lower()): c for c in answer.causes}
    for joint in ("pitch", "elbow"):
        assert abs(found["gravity_load", joint].parameters["force"].value) == pytest.approx(0.037, abs=0.005)
    assert {c.actuator.lower() for c in answer.causes if c.family == "timing"} >= {"rotation", "wrist_roll", "jaw"}
    assert {c.actuator.lower() for c in answer.causes if c.effect == "coulomb_friction"} >= {
        "rotation",
        "pitch",
        "elbow",
    }
    assert not {"lost_motion"} & {c.family for c in answer.causes}


def test_with_a_model_the_friction_of_a_joint_is_found(tmp_path, log):
    """The drawn arm of `conftest.py`, whose actuators turn the action into torques."""
    folder = write_data_set(
        tmp_path / "set", "v3.0", 1.0 / np.diff(log.time)[0], ["a", "b"], [(None, log.ctrl, log.qpos)]
    )
    (cause,) = gap.from_lerobot(folder, log.xml, unit="rad").causes
    assert (cause.effect, cause.actuator) == ("coulomb_friction", "shoulder")
    assert cause.parameters["force"].value == pytest.approx(1.2, rel=0.1)


def test_joints_are_taken_by_their_names_where_the_model_has_them(tmp_path, log):
    """In another order than the model's; of three episodes that the data set has, one is in its folder."""
    rate, turned = 1.0 / np.diff(log.time)[0], (None, log.ctrl[:, ::-1], log.qpos[:, ::-1])
    folder = write_data_set(tmp_path / "set", "v3.0", rate, ["shoulder", "turn"], [turned])
    info = json.loads((folder / "meta/info.json").read_text())
    (folder / "meta/info.json").write_text(json.dumps({**info, "total_episodes": 3}))
    answer = gap.from_lerobot(folder, log.xml, unit="rad")
    assert [(c.effect, c.actuator) for c in answer.causes] == [("coulomb_friction", "shoulder")]
    assert "joints are those of the data set's names: shoulder, turn" in answer.guessed
    assert "1 of the data set's 3 episodes are in its folder" in answer.notes


def test_joints_of_a_model_without_actuators_are_servos(tmp_path, log):
    """As the URDF of an arm of servos, whose log has no efforts: as late as without a model."""
    bare = log.xml.read_text() if isinstance(log.xml, Path) else log.xml
    (tmp_path / "bare.xml").write_text(bare[: bare.index("<actuator>")] + bare[bare.index("</actuator>") + 11 :])
    late = np.concatenate([log.qpos[:1].repeat(30, axis=0), log.qpos[:-30]])
    folder = write_data_set(tmp_path / "set", "v3.0", 1.0 / np.diff(log.time)[0], ["a", "b"], [(None, log.qpos, late)])
    alone, beside = (gap.from_lerobot(folder, model, unit="rad") for model in (None, tmp_path / "bare.xml"))
    assert beside.causes and beside.causes == alone.causes
    assert any("each joint is a servo" in guess for guess in beside.guessed)
