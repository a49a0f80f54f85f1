"""Models that MuJoCo puts together: files it includes, macros, frames and classes of defaults."""

import mujoco
import pytest
from sher3_export import ExportError, export
from sher3_export.targets.mjcf.whole import read_mjcf
from verdicts import cause, verdict

ROBOT = """<mujoco><compiler angle="radian"/><include file="sub/classes.xml"/>
<default><default class="leg"><joint frictionloss="0.3"/></default></default>
<worldbody><frame pos="0 0 .5" childclass="arm"><include file="sub/arm.xml"/></frame>{more}</worldbody>
<actuator><position class="arm" joint="shoulder"/><position joint="elbow" kp="200" kv="8"/></actuator></mujoco>"""
CLASSES = """<mujocoinclude><default><default class="arm"><joint axis="0 1 0" damping=".5"/><position kp="400" kv="20"/>
</default></default></mujocoinclude>"""
ARM = """<mujocoinclude><body name="upper"><frame pos="0 0 .1"><joint name="shoulder"/>
<geom size=".1" mass="2"/></frame><include file="sub/lower.xml"/></body></mujocoinclude>"""
LOWER = """<mujocoinclude><body name="lower" pos=".4 0 0"><joint name="elbow"/><geom size=".1" mass="1"/></body>
</mujocoinclude>"""
LEGS = """<replicate count="2" offset="0 1 0" sep="_"><body name="leg" childclass="leg"><joint name="hip"/>
<geom size=".1"/></body></replicate>"""


@pytest.fixture
def robot(tmp_path):
    """Return what writes the robot with more in its world, and gives its path."""
    (tmp_path / "sub").mkdir()
    for name, text in (("classes", CLASSES), ("arm", ARM), ("lower", LOWER)):
        (tmp_path / "sub" / f"{name}.xml").write_text(text)

    def write(more=""):
        (tmp_path / "robot.xml").write_text(ROBOT.format(more=more))
        return tmp_path / "robot.xml"

    return write


@pytest.mark.parametrize("more", ["", LEGS])
def test_causes_are_written_into_the_model_in_one_piece(robot, more):
    path = robot(more)
    friction, gain = (
        cause("viscous_friction", "shoulder", extra=0.7),
        cause("torque_constant", "shoulder", unit="1", relative=0.1),
    )
    mass = cause("link_mass", "upper", unit="1", relative=0.5)
    done = export(verdict(friction, gain, mass), "mjcf", path)
    assert not done.not_expressed
    before, after = mujoco.MjModel.from_xml_path(str(path)), mujoco.MjModel.from_xml_string(done.text)
    names = [before.joint(i).name for i in range(before.njnt)]
    assert names == [after.joint(i).name for i in range(after.njnt)]
    added = after.dof_damping - before.dof_damping
    assert added[names.index("shoulder")] == pytest.approx(0.7) and added.sum() == pytest.approx(0.7)
    assert after.actuator_gainprm[:, 0] == pytest.approx(before.actuator_gainprm[:, 0] * [1.1, 1.0])
    assert after.actuator_biasprm[:, 2] == pytest.approx(before.actuator_biasprm[:, 2] * [1.1, 1.0])
    assert after.body("upper").mass == pytest.approx(3.0) and after.body("lower").mass == pytest.approx(1.0)
    assert after.dof_frictionloss == pytest.approx(before.dof_frictionloss)


def test_a_replicated_joint_is_one_of_its_own(robot):
    done = export(verdict(cause("coulomb_friction", "hip_1", force=0.2)), "mjcf", robot(LEGS))
    model = mujoco.MjModel.from_xml_string(done.text)
    assert [model.joint(f"hip_{k}").frictionloss[0] for k in range(2)] == pytest.approx([0.3, 0.5])


def test_a_joint_in_a_frame_is_parted_from_its_load_where_the_frame_places_it(robot):
    done = export(verdict(cause("backlash", "shoulder", unit="rad", width=0.01)), "mjcf", robot())
    model = mujoco.MjModel.from_xml_string(done.text)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    plain = export(verdict(cause("coulomb_friction", "shoulder", force=0.1)), "mjcf", robot())
    bare = mujoco.MjModel.from_xml_string(plain.text)
    standing = mujoco.MjData(bare)
    mujoco.mj_forward(bare, standing)
    for joint in ("shoulder", "shoulder_play"):
        assert data.joint(joint).xanchor == pytest.approx(standing.joint("shoulder").xanchor)
        assert data.joint(joint).xaxis == pytest.approx(standing.joint("shoulder").xaxis)
    assert data.body("upper").xpos == pytest.approx(standing.body("upper").xpos)
    assert model.joint("shoulder_play").range == pytest.approx([-0.005, 0.005])


def test_files_that_include_each_other_or_are_missing_are_refused(tmp_path):
    path = tmp_path / "robot.xml"
    path.write_text('<mujoco><include file="robot.xml"/></mujoco>')
    with pytest.raises(ExportError, match="include each other"):
        read_mjcf(path)
    path.write_text('<mujoco><include file="none.xml"/></mujoco>')
    with pytest.raises(ExportError, match="none"):
        read_mjcf(path)
