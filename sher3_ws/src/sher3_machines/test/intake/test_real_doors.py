"""Measured records as they were published: each opens, and what can be drafted of it is imported as drafted."""

import os
from pathlib import Path

import pytest
from sher3_machines import MachineError, import_case, load_description, open_case
from sher3_machines.drafting.drafts import draft_of
from sher3_machines.intake.tables import read_tables

SHARED = Path(os.environ.get("SHER3_SHARED", Path(__file__).parents[5].parent / "shared"))
REAL = SHARED / "real"
pytestmark = [pytest.mark.shared, pytest.mark.skipif(not REAL.is_dir(), reason=f"no data sets in {REAL}")]

EPOS = "rvim_screw_drives/experiments"
SWINGUP = "dfki_simple_pendulum/results/control_method_pd/1nm_torque_limited_swingup_failure"
DRAFTED = {
    "kuka_kr300/runA.mat": (6, {"position", "reference", "effort", "load"}, 2501),
    "davinci_tool/00.TXT": (3, {"position"}, 19994),
    "dfki_double_pendulum/A0.csv": (2, {"position", "effort", "velocity"}, 4995),
    "dfki_double_pendulum/C0_0.csv": (2, {"position", "effort", "velocity"}, 4999),
    "emps/DATA_EMPS.mat": (1, {"position", "reference", "command"}, 24841),
    "rhoban_mx_drop/friction_1.json": (1, {"position"}, 313),
    "sage_so101/output/real/so101/custom/step_response": (6, {"position", "reference"}, 6000),
    "tiago_dynamics": (8, {"position", "effort", "velocity"}, 8022),
    f"{EPOS}/driveNo1/start_stop/200.csv": (1, {"position", "effort"}, 500),
    f"{EPOS}/driveNo3/steady_state/0.096kg/2.csv": (1, {"position", "effort"}, 500),
    SWINGUP: (1, {"position", "velocity"}, 8000),
}
"""File -> axes, signals that every axis has in the draft, samples about."""


@pytest.mark.parametrize("name", DRAFTED)
def test_a_draft_is_imported_as_it_is(name, tmp_path):
    axes, signals, samples = DRAFTED[name]
    (tmp_path / "d.yaml").write_text(draft_of(REAL / name).text, encoding="utf-8")
    found = load_description(tmp_path / "d.yaml").axes
    told = [set(axis.signals.model_dump(exclude_none=True)) for axis in found]
    assert len(found) == axes and set.union(*told) >= signals - {"velocity"}, told
    assert set.intersection(*told) >= signals - {"velocity", "load"}, told  # wrists may have no second encoder
    assert any(signals <= x for x in told)
    import_case([REAL / name], tmp_path / "d.yaml", tmp_path / "case")
    runs = open_case(tmp_path / "case")[1]
    recorded = sum(len(next(iter(run.signals.values()))["position"]) for run in runs)
    assert recorded == pytest.approx(samples, rel=0.05)


@pytest.mark.parametrize(
    ("name", "shape"),
    [
        ("pneumatic_seals/KDN_1bar.csv", {"c0": (6857,), "c6": (6857,)}),
        ("franka_fr3_calib/calib_data_converted.npz", {"camera_poses": (114, 4, 4)}),
    ],
)
def test_columns_without_names_are_read_and_a_draft_says_what_to_write(name, shape):
    found = read_tables(REAL / name)
    assert {column: found[column].shape for column in shape} == shape
    with pytest.raises(MachineError, match=r"--names|time: \{column: data, index: 0\}"):
        draft_of(REAL / name)


def test_place_and_speed_of_a_matrix_are_told_by_the_motion():
    name = "brfd_damper/dataset-1_1Hz35lbtension.json"
    assert read_tables(REAL / name)["data"].shape == (10241, 6)
    found = draft_of(REAL / name)
    assert "data[1] is a position" in found.text
