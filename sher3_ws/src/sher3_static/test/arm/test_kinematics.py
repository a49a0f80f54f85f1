"""Forward kinematics against geometry worked out by hand, and the two sources of an arm against each other."""

import numpy as np
import pytest
from arms import ROWS, machine
from sher3_machines import MachineError
from sher3_static.arm.kinematics import postures, transform
from sher3_static.arm.urdf import arm_from_urdf

URDF = """<robot name="two"><link name="base"/><link name="a"/><link name="b"/><link name="tip"/>
<joint name="j1" type="revolute"><parent link="base"/><child link="a"/>
<origin xyz="0 0 0.3" rpy="0 0 0"/><axis xyz="0 0 2"/></joint>
<joint name="j2" type="{kind}"><parent link="a"/><child link="b"/>
<origin xyz="0 0 0" rpy="-1.5707963267948966 0 0"/><axis xyz="0 0 1"/></joint>
<joint name="end" type="fixed"><parent link="b"/><child link="tip"/><origin xyz="0.25 0 0.1"/></joint></robot>"""


@pytest.fixture
def urdf(tmp_path):
    path = tmp_path / "two.urdf"
    path.write_text(URDF.format(kind="revolute"))
    return path


def test_a_planar_arm_reaches_as_far_as_its_links():
    """Two links of 0.3 and 0.2 m: stretched 0.5 m along x, the elbow at a right angle (0.3, 0.2)."""
    arm = machine([(0.0, 0.0, 0.0), (0.3, 0.0, 0.0), (0.2, 0.0, 0.0)]).known.arm
    along = postures(arm, np.array([[0.0, 0.0, 0.0], [0.0, np.pi / 2, 0.0]]))
    np.testing.assert_allclose(along.tip[:, :3, 3], [[0.5, 0.0, 0.0], [0.3, 0.2, 0.0]], atol=1e-12)
    np.testing.assert_allclose(along.frames[1, 2, :3, 3], [0.3, 0.2, 0.0], atol=1e-12)
    np.testing.assert_allclose(along.axes, np.broadcast_to([0.0, 0.0, 1.0], (2, 3, 3)), atol=1e-12)


def test_a_twisted_joint_turns_about_another_axis():
    """A twist of -90 degrees: the second joint's z lies along the base's y."""
    arm = machine([(0.0, 0.3, 0.0), (0.0, 0.0, -np.pi / 2)]).known.arm
    np.testing.assert_allclose(postures(arm, np.zeros((1, 2))).axes[0, 1], [0.0, 1.0, 0.0], atol=1e-12)


def test_a_transform_is_identity_unless_told():
    np.testing.assert_array_equal(transform(), np.eye(4))
    assert transform([1.0, 2.0, 3.0])[:3, 3].tolist() == [1.0, 2.0, 3.0]


def test_urdf_and_table_agree(urdf):
    q = np.random.default_rng(1).uniform(-1, 1, (5, 2))
    by_urdf = postures(arm_from_urdf(urdf, "base", "tip"), q).tip
    by_table = postures(machine(ROWS[:2]).known.arm, q).tip @ transform([0.25, 0.0, 0.1])
    np.testing.assert_allclose(by_urdf, by_table, atol=1e-12)


def test_axes_of_a_urdf_are_unit_vectors(urdf):
    arm = arm_from_urdf(urdf, "base", "tip")
    assert arm.names == ("j1", "j2") and arm.axes[0].tolist() == [0.0, 0.0, 1.0]


def test_a_chain_that_is_not_there_is_named(urdf, tmp_path):
    with pytest.raises(MachineError, match="no chain from 'base' to 'hand'"):
        arm_from_urdf(urdf, "base", "hand")
    with pytest.raises(MachineError, match="no chain from 'tip' to 'base'"):
        arm_from_urdf(urdf, "tip", "base")
    (tmp_path / "float.urdf").write_text(URDF.format(kind="floating"))
    with pytest.raises(MachineError, match="j2 neither turns nor slides"):
        arm_from_urdf(tmp_path / "float.urdf", "base", "tip")


def test_a_joint_that_slides_moves_the_tip_along_its_axis(tmp_path):
    """Its axis lies along the base's y: 0.2 m of travel add to 0.1 m of the tip; only the other one may be wrong."""
    (tmp_path / "slide.urdf").write_text(URDF.format(kind="prismatic"))
    arm = arm_from_urdf(tmp_path / "slide.urdf", "base", "tip")
    (tip,) = postures(arm, np.array([[0.0, 0.2]])).tip
    np.testing.assert_allclose(tip[:3, 3], [0.25, 0.3, 0.3], atol=1e-12)
    assert arm.turning == ("j1",)


def test_a_urdf_that_goes_round_in_a_circle_is_refused(tmp_path):
    text = '<robot name="ring"><link name="a"/><link name="b"/>'
    for name, parent, child in (("one", "a", "b"), ("two", "b", "a")):
        text += f'<joint name="{name}" type="fixed"><parent link="{parent}"/><child link="{child}"/></joint>'
    (tmp_path / "ring.urdf").write_text(text + "</robot>")
    with pytest.raises(MachineError, match="no chain"):
        arm_from_urdf(tmp_path / "ring.urdf", "base", "b")
