"""Measured poses in every form people write them in."""

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.spatial.transform import Rotation
from sher3_machines import MachineError
from sher3_machines.intake.fields import Column
from sher3_machines.intake.poses import Pose, poses_of

TURNS = Rotation.from_euler("xyz", np.random.default_rng(1).uniform(-1.0, 1.0, (6, 3)))
PLACES = np.random.default_rng(2).uniform(-500.0, 500.0, (6, 3))
"""Turns, and positions in mm."""
QUATERNION = TURNS.as_quat()
EULER = np.degrees(TURNS.as_euler("ZYX"))
MATRIX = np.tile(np.eye(4), (6, 1, 1))
MATRIX[:, :3, :3], MATRIX[:, :3, 3] = TURNS.as_matrix(), PLACES
TABLES = {
    "p": PLACES,
    "q": QUATERNION,
    "T": MATRIX,
    "flat": MATRIX.reshape(-1, 16),
    **{f"w{i}": QUATERNION[:, [3, 0, 1, 2]][:, i] for i in range(4)},
    **{f"e{i}": EULER[:, i] for i in range(3)},
}


def column(name, unit="mm"):
    return {"column": name, "unit": unit}


@pytest.mark.parametrize(
    "pose",
    [
        Column(column="T", unit="mm"),
        Column(column="flat", unit="mm"),
        Pose(position=column("p"), quaternion=column("q", "1")),
        Pose(position=column("p"), quaternion=tuple(column(f"w{i}", "1") for i in range(4)), order="wxyz"),
        Pose(position=column("p"), euler=tuple(column(f"e{i}", "deg") for i in range(3)), axes="ZYX"),
    ],
    ids=["matrix", "flat", "quaternion", "columns", "euler"],
)
def test_every_form_is_the_same_pose(pose):
    found = poses_of(pose, TABLES, "a")
    assert found[:, :3, 3] == pytest.approx(PLACES * 1e-3)
    assert found[:, :3, :3] == pytest.approx(TURNS.as_matrix(), abs=1e-9)


def test_what_is_no_pose_is_refused():
    unset = {**TABLES, "q": np.zeros((6, 4))}
    with pytest.raises(MachineError, match="norm 0"):
        poses_of(Pose(position=column("p"), quaternion=column("q", "1")), unset, "a")
    with pytest.raises(MachineError, match="another width"):
        poses_of(Pose(position=column("q"), quaternion=column("q", "1")), TABLES, "a")
    with pytest.raises(MachineError, match="not matrices"):
        poses_of(Column(column="p", unit="mm"), TABLES, "a")
    with pytest.raises(ValidationError, match="either"):
        Pose(position=column("p"))
    with pytest.raises(ValidationError, match="xyz"):
        Pose(position=column("p"), euler=column("p"), axes="xYz")
