"""An arm in measured postures drafted from a table and its URDF."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from sher3_common import parse_yaml
from sher3_diagnosis import diagnose
from sher3_machines import import_case, open_case
from sher3_machines.drafting.drafts import draft_of
from sher3_static.arm.draft import draft_postures, points

AXES = {"pan": "z", "lift": "y", "elbow": "y", "roll": "z"}
LENGTH = 0.4
URDF = (
    '<robot name="arm"><link name="world"/><link name="base"/>'
    + "".join(f'<link name="{name}_link"/>' for name in AXES)
    + '<joint name="stand" type="fixed"><parent link="world"/><child link="base"/></joint>'
    + "".join(
        f'<joint name="{name}_joint" type="revolute"><parent link="{before}"/><child link="{name}_link"/>'
        f'<origin xyz="0 0 {LENGTH}"/><axis xyz="{int(axis == "x")} {int(axis == "y")} {int(axis == "z")}"/></joint>'
        for before, (name, axis) in zip(("base", *(f"{n}_link" for n in AXES)), AXES.items(), strict=False)
    )
    + "".join(f'<transmission name="{name}"><joint name="{name}_joint"/></transmission>' for name in AXES)
    + "</robot>"
)


def seen(q, target=(0.1, 0.05, 0.2)):
    """Where a target on the last link is, m, for joint positions (4,)."""
    place = np.array(target)
    for axis, angle in reversed(list(zip(AXES.values(), q, strict=True))):
        place = Rotation.from_euler(axis, angle).apply(place) + np.array([0.0, 0.0, LENGTH])
    return place


def table(tmp_path, header, seed, zero=0.0, unit=1.0, postures=60):
    """Postures of a drawn arm whose lift reads `zero` too much, as a csv beside the model."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(-1.2, 1.2, (postures, 4))
    places = np.array([seen(x - [0.0, zero, 0.0, 0.0]) for x in q]) + 1e-4 * rng.standard_normal((postures, 3))
    rows = np.column_stack([places * unit, q[:, [2, 0, 1, 3]]])
    np.savetxt(tmp_path / "a.csv", rows, delimiter=",", header=header, comments="", fmt="%.9g")
    (tmp_path / "arm.urdf").write_text(URDF)
    return draft_of(tmp_path / "a.csv", model=tmp_path / "arm.urdf")


@pytest.mark.parametrize(
    ("header", "unit"),
    [
        ("x1,y1,z1,elbow_joint,pan_joint,lift_joint,roll_joint", 1.0),
        ("tip_X [mm],tip_Y [mm],tip_Z [mm],Elbow Joint,Pan Joint,Lift Joint,Roll Joint", 1e3),
        ("x,y,z,elbow_joint,pan_joint,lift_joint,roll_joint", 1e3),
    ],
)
def test_a_table_of_postures_is_drafted_and_its_zero_found(tmp_path, header, unit):
    found = table(tmp_path, header, seed=1, zero=0.01, unit=unit)
    described = parse_yaml(found.text)
    assert described["kind"] == "arm" and described["base_link"] == "base" and described["tip_link"] == "roll_link"
    joints = [c["column"].lower().replace(" ", "_") for c in described["joint_positions"]]
    assert joints == ["pan_joint", "lift_joint", "elbow_joint", "roll_joint"]
    assert {c["unit"] for c in described["positions"]} == {"m" if unit == 1.0 else "mm"}
    (tmp_path / "a.yaml").write_text(found.text, encoding="utf-8")
    import_case([tmp_path / "a.csv"], tmp_path / "a.yaml", tmp_path / "case")
    verdict = diagnose(*open_case(tmp_path / "case")).verdict
    offsets = {c.actuator: c.parameters["offset"].value for c in verdict.causes if c.effect == "encoder_offset"}
    assert offsets["lift_joint"] == pytest.approx(0.01, abs=1e-3)


@pytest.mark.parametrize("entry", ["m_{}{}", "T{}{}", "pose_{}_{}", "r{},{}"])
@pytest.mark.parametrize("first", [0, 1])
def test_the_point_of_a_pose_that_is_a_matrix_is_its_last_column(entry, first):
    names = [entry.format(first + i, first + j) for i in range(4) for j in range(4)]
    columns = {name: np.arange(30.0) for name in ("q1", "q2", *names)}
    assert list(points(columns).values()) == [names[3:12:4]]
    del columns[names[5]]
    assert not points(columns)


@pytest.mark.parametrize(
    "header", ["t,x,y,z,pan_joint,lift_joint", "x,y,z,left,right,up", "x,y,w,a,pan_joint,lift_joint"]
)
def test_what_has_a_clock_or_no_joints_or_no_point_is_no_table_of_postures(tmp_path, header):
    (tmp_path / "arm.urdf").write_text(URDF)
    columns = {name: np.arange(30.0) for name in header.split(",")}
    assert draft_postures(tmp_path / "a.csv", columns, tmp_path / "arm.urdf") is None


def test_numbered_columns_are_the_joints_that_move_in_order(tmp_path):
    described = parse_yaml(table(tmp_path, "x,y,z,q3,q1,q2,q4", seed=3).text)
    assert [c["column"] for c in described["joint_positions"]] == ["q1", "q2", "q3", "q4"]
    assert (described["base_link"], described["tip_link"]) == ("base", "roll_link")


def test_a_joint_called_t_that_goes_both_ways_is_no_clock(tmp_path):
    (tmp_path / "arm.urdf").write_text(URDF.replace("roll_joint", "t"))
    rng = np.random.default_rng(4)
    columns = {name: rng.normal(size=30) for name in ("x", "y", "z", "lift_joint", "elbow_joint", "t")}
    found = draft_postures(tmp_path / "a.csv", columns, tmp_path / "arm.urdf")
    assert found is not None and [c["column"] for c in parse_yaml(found.text)["joint_positions"]][-1] == "t"
