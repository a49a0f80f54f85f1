"""Models and records that a simulator takes as they are: clipped controls, free bodies, URDFs without drives."""

import mujoco
import numpy as np
import pytest
import sher3.gap as gap
from drawn_arms import asked
from sher3_machines.errors import MachineError

ARM = """<mujoco><option timestep="0.002"/><worldbody>{body}<body pos="0 0 0.5">
<joint name="shoulder" axis="0 1 0" damping="0.5" armature="0.02"/>
<geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.03" mass="2"/><body pos="0.4 0 0">
<joint name="elbow" axis="0 1 0" damping="0.2" armature="0.01"/>
<geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.025" mass="1"/></body></body></worldbody><actuator>
<position joint="shoulder" kp="400" kv="20" {range}/><position joint="elbow" kp="200" kv="8" {range}/></actuator>
</mujoco>"""
CUBE = '<body name="cube" pos="2 0 1" gravcomp="1"><freejoint/><geom size=".05" mass=".1"/></body>'
URDF = """<robot name="arm"><link name="base"/>
<link name="upper"><inertial><origin xyz="0.2 0 0"/><mass value="2"/>
<inertia ixx="0.001" iyy="0.03" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="lower"><inertial><origin xyz="0.15 0 0"/><mass value="1"/>
<inertia ixx="0.0005" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" effort="99" velocity="9"/></joint>
<joint name="elbow" type="revolute"><origin xyz="0.4 0 0"/><parent link="upper"/><child link="lower"/>{mimic}
<axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="99" velocity="9"/></joint></robot>"""
GAINS = {"shoulder": (400.0, 20.0), "elbow": (200.0, 8.0)}


def log_of(xml, size=1.0):
    """Return stamps, controls, the whole qpos with noise of an encoder, and `qfrc_actuator`."""
    model = mujoco.MjModel.from_xml_string(xml)
    state, rows = mujoco.MjData(model), []
    for place in size * asked(np.random.default_rng(5), np.arange(6000) * model.opt.timestep, 2):
        state.ctrl[:] = place
        mujoco.mj_forward(model, state)
        rows.append([state.time, *place, *state.qpos, *state.qfrc_actuator])
        mujoco.mj_step(model, state)
    time, control, position, effort = np.split(np.array(rows), np.cumsum([1, 2, model.nq]), axis=1)
    return time[:, 0], control, position + 1e-5 * np.random.default_rng(1).normal(size=position.shape), effort


def test_a_control_beyond_its_range_acts_as_its_bound():
    """MuJoCo clips it; a log holds what was asked for."""
    xml = ARM.format(body="", range='ctrllimited="true" ctrlrange="-0.4 0.4"')
    time, control, position, effort = log_of(xml)
    assert np.abs(control).max() > 0.6
    assert gap.diagnose(xml, time, control, position).status == "no_gap"
    assert gap.diagnose(xml, {"time": time, "ctrl": control, "qpos": position}).status == "no_gap"
    assert gap.diagnose(xml, time, control, position, effort).status == "no_gap"


@pytest.mark.parametrize("as_spec", [False, True])
def test_a_model_of_several_files_and_macros(tmp_path, as_spec):
    """A file of the arm, and a scene that includes it beside a copied pendulum that was not recorded."""
    post = '<body pos="0 2 0"><joint name="post"/><geom size=".1"/></body>'
    scene = f'<worldbody><frame pos="0 0 .1"><replicate count="2" offset="0 1 0">{post}</replicate></frame></worldbody>'
    xml = ARM.format(body="", range="")
    (tmp_path / "arm.xml").write_text(xml)
    path = tmp_path / "scene.xml"
    path.write_text(f'<mujoco><include file="arm.xml"/>{scene}</mujoco>')
    time, control, position, effort = log_of(xml.replace('damping="0.5"', 'damping="2.5"'))
    model = mujoco.MjSpec.from_file(str(path)) if as_spec else path
    found = gap.diagnose(model, time, control, position, effort, joints=["shoulder", "elbow"])
    assert [(c.effect, c.actuator) for c in found.causes] == [("viscous_friction", "shoulder")]
    done = found.corrected()
    corrected = mujoco.MjModel.from_xml_string(done.text)
    assert not done.not_expressed and corrected.njnt == 4
    assert corrected.joint("shoulder").damping[0] == pytest.approx(2.5, rel=0.02)
    replay = found.simulate().joints["shoulder"]
    assert replay.after < 0.2 * replay.before


@pytest.mark.parametrize("steps", [5, -10])
def test_a_control_that_acts_late_is_named_where_no_effort_was_recorded(steps):
    """Its law stands for the effort; the plant followed the control of ten ms before, or it was logged too late."""
    xml = ARM.format(body="", range="")
    time, control, position, _ = log_of(xml)
    last = len(time) - 1
    found = gap.diagnose(xml, time, control[np.clip(np.arange(len(time)) + steps, 0, last)], position)
    assert {(c.effect, c.actuator) for c in found.causes} == {("command_delay", j) for j in ("shoulder", "elbow")}
    for cause in found.causes:
        assert cause.parameters["reference_delay"].value == pytest.approx(0.002 * steps, rel=0.02)
        assert "sensor_delay" in cause.rivals
    assert any("control and motion lie apart in time" in note for note in found.verdict.notes)


def test_friction_is_no_late_control_where_no_effort_was_recorded():
    xml = ARM.format(body="", range="")
    time, control, position, _ = log_of(xml.replace('damping="0.5"', 'damping="4.5"'))
    found = gap.diagnose(xml, time, control, position)
    assert [(c.effect, c.actuator) for c in found.causes] == [("viscous_friction", "shoulder")]


def test_a_joint_at_its_stop_is_not_judged_there():
    """Its servo asks for twice what the range allows: the stop's force is in no law."""
    xml = ARM.format(body="", range="").replace('name="elbow" axis', 'name="elbow" limited="true" range="-20 20" axis')
    time, control, position, _ = log_of(xml)
    found = gap.diagnose(xml, time, control, position)
    assert found.status == "no_gap" and any("elbow: lies beyond the range" in note for note in found.verdict.notes)


def test_a_joint_that_is_drawn_where_it_does_not_read_zero():
    """A healthy arm whose shoulder reads 0.3 rad, and whose elbow -0.5 rad, as drawn."""
    xml = ARM.format(body="", range="").replace("<option", '<compiler angle="radian"/><option')
    for name, ref in (("shoulder", 0.3), ("elbow", -0.5)):
        xml = xml.replace(f'name="{name}" axis', f'name="{name}" ref="{ref}" axis')
    time, control, position, _ = log_of(xml)
    assert gap.diagnose(xml, time, control, position).status == "no_gap"


def test_forces_of_actuators_before_their_gear_are_not_taken_for_degrees():
    xml = ARM.format(body="", range="").replace('position joint="shoulder"', 'position gear="40" joint="shoulder"')
    time, _, position, effort = log_of(xml.replace('kp="400" kv="20"', 'kp="0.25" kv="0.0125"'), size=1.5)
    with pytest.raises(MachineError, match="state `factor` of a column or `gain`"):
        gap.diagnose(xml, time, None, position, effort / np.array([40.0, 40.0]))


def test_efforts_as_wide_as_mujoco_s_speeds():
    time, control, position, effort = log_of(ARM.format(body=CUBE, range=""))
    assert (position.shape[1], effort.shape[1]) == (9, 8)
    assert gap.diagnose(ARM.format(body=CUBE, range=""), time, control, position, effort).status == "no_gap"


def test_small_angles_in_degrees():
    """Of ten degrees nobody knows that they are no radians, but the weights of the links."""
    xml = ARM.format(body="", range="")
    time, control, position, effort = log_of(xml, size=0.15)
    assert 6.0 < np.degrees(np.abs(position).max()) < 12.0
    for own in (None, effort):
        with pytest.raises(gap.InputError, match="likely in degrees"):
            gap.diagnose(xml, time, np.degrees(control), np.degrees(position), own)
    units = {"position": "deg", "control": "deg"}
    assert gap.diagnose(xml, time, np.degrees(control), np.degrees(position), units=units).status == "no_gap"
    lighter = mujoco.MjSpec.from_string(xml)
    lighter.option.gravity = [0.0, 0.0, 0.0]  # balanced, which its model does not know: no reason for another unit
    time, control, position, _ = log_of(lighter.to_xml())
    assert gap.diagnose(xml, time, control, position).status != "no_gap"


def driven_urdf():
    """Return stamps, references, positions and torques of a digital PD law on the bodies of the URDF."""
    model = mujoco.MjModel.from_xml_string(URDF.format(mimic=""))
    state, rows, (stiff, damped) = mujoco.MjData(model), [], np.array(list(GAINS.values())).T
    for place in asked(np.random.default_rng(5), np.arange(6000) * model.opt.timestep, 2):
        state.qfrc_applied[:] = stiff * (place - state.qpos) - damped * state.qvel
        rows.append([state.time, *place, *state.qpos, *state.qfrc_applied])
        mujoco.mj_step(model, state)
    time, reference, position, effort = np.split(np.array(rows), [1, 3, 5], axis=1)
    return time[:, 0], reference, position + 1e-5 * np.random.default_rng(1).normal(size=position.shape), effort


@pytest.fixture(scope="module")
def urdf_log():
    return driven_urdf()


def test_a_urdf_with_the_gains_of_its_servos(urdf_log):
    time, reference, position, _ = urdf_log
    assert gap.diagnose(URDF.format(mimic=""), time, reference, position, servo=GAINS).status == "no_gap"
    with pytest.raises(MachineError, match="servo="):
        gap.diagnose(URDF.format(mimic=""), time, reference, position)


FINGER = """<body name="finger" pos="0.3 0 0"><joint name="finger" axis="0 1 0"/>
<geom type="capsule" fromto="0 0 0 0.1 0 0" size="0.01" mass="0.3"/></body></body></body></worldbody><equality>
<joint joint1="finger" joint2="elbow" polycoef="0.2 -1 0 0 0" solref="0.004 1"/></equality>"""


@pytest.mark.parametrize("columns", [2, 3], ids=["recorded without its follower", "and with it"])
def test_a_joint_that_an_equality_lets_another_follow(columns):
    """The finger weighs on the elbow, and its friction of 1.2 N m is found beside that."""
    xml = ARM.format(body="", range="").replace("</body></body></worldbody>", FINGER)
    robot = mujoco.MjSpec.from_string(xml)
    robot.joint("elbow").frictionloss = 1.2
    time, control, position, _ = log_of(robot.to_xml())
    found = gap.diagnose(xml, time, control, position[:, :columns])
    assert [(c.effect, c.actuator) for c in found.causes] == [("coulomb_friction", "elbow")]
    assert any("finger follows elbow: -1 times its place +0.2" in guess for guess in found.guessed)


def test_the_model_of_another_robot_is_said():
    """Longer and lighter: what wears changes no link."""
    xml = ARM.format(body="", range="")
    other = (
        xml.replace("0 0 0 0.4 0 0", "0 0 0 0.6 0 0")
        .replace('pos="0.4 0 0"', 'pos="0.6 0 0"')
        .replace('mass="1"', 'mass="0.3"')
    )
    found = gap.diagnose(xml, *log_of(other))
    (note,) = [x for x in found.notes if x.startswith("the model may be that of another robot")]
    assert "which no wear changes; give the model of this robot" in note
    assert {c.effect for c in found.causes} & {"link_inertia", "link_mass"}


def test_a_joint_that_mimics_another_is_not_judged_by_itself(urdf_log):
    time, _, position, effort = urdf_log
    model = URDF.format(mimic='<mimic joint="shoulder"/>')
    for columns, names in ((1, ["shoulder"]), (2, [])):
        found = gap.diagnose(model, time, None, position[:, :columns], effort[:, :columns], joints=names)
        assert any("elbow follows shoulder: 1 times its place, and" in guess for guess in found.guessed)
        assert {c.actuator for c in found.causes} <= {"shoulder", "upper", "lower"}


def test_runs_with_other_columns(urdf_log):
    time, _, q, effort = urdf_log
    with pytest.raises(gap.InputError, match="position differs between runs"):
        gap.diagnose(URDF.format(mimic=""), [time, time], None, [q, q[:, :1]], [effort, effort[:, :1]])


def test_a_joint_that_never_moved_and_efforts_in_another_unit(urdf_log):
    time, _, q, effort = urdf_log
    with pytest.raises(MachineError, match="no joint can be judged"):
        gap.diagnose(ARM.format(body="", range=""), time, 0.0 * q, 0.0 * q)
    with pytest.raises(MachineError, match="this many times what the model needs"):
        gap.diagnose(URDF.format(mimic=""), time, None, q, 37.0 * effort)


def test_a_urdf_says_where_the_stops_are():
    """Torques throw the pendulum against a stop at half a radian, of which its limits tell."""
    urdf = """<robot name="r"><link name="base"/><link name="arm"><inertial><origin xyz="0.2 0 0"/><mass value="2"/>
    <inertia ixx="0.01" iyy="0.03" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <joint name="swing" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-0.5" upper="0.5" effort="99" velocity="9"/></joint></robot>"""
    model = mujoco.MjModel.from_xml_string(urdf)
    model.opt.timestep = 0.001
    data, rows = mujoco.MjData(model), []
    for k in range(12_000):
        t = 0.001 * k
        data.qfrc_applied[0] = (
            60.0 * (0.5 * np.sin(2.1 * t) + 0.25 * np.sin(5.3 * t) - data.qpos[0]) - 3.0 * data.qvel[0]
        )
        rows.append([t, data.qpos[0], data.qfrc_applied[0]])
        mujoco.mj_step(model, data)
    time, place, torque = np.array(rows).T
    position = place + 1e-6 * np.random.default_rng(1).normal(size=len(place))
    found = gap.diagnose(urdf, time, None, position[:, None], torque[:, None])
    assert found.status == "no_gap" and any("swing: lies beyond the range" in note for note in found.verdict.notes)
