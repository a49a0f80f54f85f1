"""Descriptions and records of other machines: what is read, and what is refused with a name."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from sher3_machines import MachineError, described, import_case, is_machine_case, load_description, open_case
from sher3_machines.intake.runs import runs_of

AXIS = {
    "name": "slide",
    "motion": "linear",
    "signals": {"position": {"column": "q", "unit": "m"}, "reference": {"column": "r", "unit": "m"}},
    "command_law": {"kind": "position"},
    "encoder_resolution": 1e-6,
}


def written(tmp_path: Path, columns: dict, name: str = "run.npz", **changes) -> tuple[Path, Path]:
    """A data file and a description beside it."""
    axis = {**AXIS, **changes}
    time = {"column": "t", "unit": "s"}
    (tmp_path / "machine.yaml").write_text(yaml.safe_dump({"kind": "axes", "name": "x", "time": time, "axes": [axis]}))
    np.savez(tmp_path / name, **columns)
    return tmp_path / name, tmp_path / "machine.yaml"


def record(n: int = 500) -> dict:
    t = np.arange(n) * 0.01
    return {"t": t, "q": 0.1 * np.sin(t), "r": 0.1 * np.sin(t)}


def test_round_trip(tmp_path):
    data, description = written(tmp_path, record())
    assert import_case([data], description, tmp_path / "case") == []
    assert is_machine_case(tmp_path / "case")
    _, runs = open_case(tmp_path / "case")
    np.testing.assert_allclose(runs[0].signals["slide"]["position"], record()["q"], atol=1e-15)
    assert runs[0].period == pytest.approx(0.01)


def test_runs_keep_the_order_in_which_they_were_given(tmp_path):
    """The first one is the reference of a contrast, whatever its name."""
    later, description = written(tmp_path, record(), "z.npz")
    earlier, _ = written(tmp_path, record(), "a.npz")
    import_case([later, earlier], description, tmp_path / "case")
    assert [run.name for run in open_case(tmp_path / "case")[1]] == ["z", "a"]
    (tmp_path / "case" / "import.json").unlink()
    assert [run.name for run in open_case(tmp_path / "case")[1]] == ["a", "z"]


def test_formats_agree(tmp_path):
    columns = record()
    data, description = written(tmp_path, columns)
    rows = ["t,q,r", *(f"{t!r},[{q!r}, 0.0],{r!r}" for t, q, r in zip(*columns.values(), strict=True))]
    lists = [r.replace("[", '"[').replace("]", ']"') for r in rows]
    (tmp_path / "run.csv").write_text("\n".join(lists).replace("np.float64(", "").replace(")", ""))
    import_case([data], description, tmp_path / "a")
    changed = yaml.safe_load(description.read_text())
    changed["axes"][0]["signals"]["position"]["index"] = 0
    description.write_text(yaml.safe_dump(changed))
    import_case([tmp_path / "run.csv"], description, tmp_path / "b")
    a, b = (open_case(tmp_path / x)[1][0].signals["slide"]["position"] for x in "ab")
    np.testing.assert_allclose(a, b)


def test_uneven_stamps_are_resampled_and_said(tmp_path):
    columns = record()
    columns["t"] = columns["t"] + 0.002 * np.random.default_rng(0).random(500)
    columns["q"] = columns["r"] = 0.1 * np.sin(columns["t"])
    notes = import_case([written(tmp_path, columns)[0]], tmp_path / "machine.yaml", tmp_path / "case")
    assert len(notes) == 1 and "resampled" in notes[0]
    run = open_case(tmp_path / "case")[1][0]
    error = run.signals["slide"]["position"] - 0.1 * np.sin(
        columns["t"][0] + run.period * np.arange(len(run.signals["slide"]["position"]))
    )
    assert np.abs(error).max() < 1e-5


def _mm(c):
    c["q"] = c["q"] * 1e3


def _nan(c):
    c["q"][7] = np.nan


def _back(c):
    c["t"][40] = c["t"][38]


def _hole(c):
    c["t"][300:] += 1.0


def _missing(c):
    del c["r"]


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (_mm, "mm recorded as m"),
        (_missing, "no column 'r'"),
    ],
)
def test_bad_records_are_named(tmp_path, spoil, words):
    columns = record()
    spoil(columns)
    data, description = written(tmp_path, columns)
    with pytest.raises(MachineError, match=words):
        import_case([data], description, tmp_path / "case")


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (_nan, "1 of 500 readings are missing or not finite"),
        (_back, "1 samples came in a wrong order"),
        (_hole, "is cut into 2 parts, because it has holes"),
    ],
)
def test_small_faults_of_a_log_are_mended_and_said(tmp_path, spoil, words):
    columns = record()
    spoil(columns)
    data, description = written(tmp_path, columns)
    notes = import_case([data], description, tmp_path / "case")
    assert any(words in note for note in notes), notes


def test_degrees_are_named(tmp_path):
    columns = record()
    columns["q"] = np.degrees(columns["r"])
    data, description = written(tmp_path, columns, motion="rotary")
    with pytest.raises(MachineError, match="deg recorded as rad"):
        import_case([data], description, tmp_path / "case")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"encoder_resolution": 0.0}, "encoder_resolution"),
        ({"motion": "round"}, "motion"),
        ({"signals": {"position": {"column": "q", "unit": "furlong"}}}, "furlong"),
        ({"signals": {"position": {"column": "q", "unit": "m"}}}, "needs its recorded reference"),
        ({"mass": -1.0}, "mass"),
    ],
)
def test_bad_descriptions_name_the_field(tmp_path, change, words):
    _, description = written(tmp_path, record(), **change)
    with pytest.raises(MachineError, match=words):
        load_description(description)


def test_descriptions_of_the_package_are_valid():
    files = sorted(described(Path("emps")).parent.glob("*.yaml"))
    assert len(files) >= 5
    for file in files:
        load_description(file)


def test_files_of_a_folder_that_are_numbered_as_runs_are_a_run_each(tmp_path):
    _, description = written(tmp_path, record())
    folder = tmp_path / "log"
    folder.mkdir()
    for name in ("run1", "run 2"):
        np.savez(folder / f"{name}.npz", **record())
    import_case([folder], description, tmp_path / "case")
    assert [run.name for run in open_case(tmp_path / "case")[1]] == ["run 2", "run1"]


def test_numbered_files_that_hold_all_joints_are_runs_and_those_of_single_joints_are_not(tmp_path):
    """`sweep_of_joint_3.npz` has a matrix of all joints; `joint_3.npz` with one position is a part of a run."""
    whole, single = tmp_path / "whole", tmp_path / "single"
    for folder, position in ((whole, np.zeros((50, 3))), (single, np.zeros(50))):
        folder.mkdir()
        for i in (1, 3):
            np.savez(folder / f"sweep_of_joint_{i}.npz", time=np.arange(50.0), q=position)
    assert list(runs_of([whole])) == ["sweep_of_joint_1", "sweep_of_joint_3"]
    assert list(runs_of([single])) == ["single"]


def test_words_behind_the_number_of_a_run_are_the_same_for_all_runs(tmp_path):
    """`a_test1_results.csv` and `a_test2_results.csv` are runs; `a_test1_pos.csv` and `a_test1_vel.csv` are signals."""
    for folder, ends in (("runs", ("1_results", "2_results")), ("signals", ("1_pos", "1_vel"))):
        (tmp_path / folder).mkdir()
        for end in ends:
            np.savetxt(
                tmp_path / folder / f"a_test{end}.csv", np.random.default_rng(0).normal(size=(50, 4)), delimiter=","
            )
    assert len(runs_of([tmp_path / "runs"])) == 2 and list(runs_of([tmp_path / "signals"])) == ["signals"]
