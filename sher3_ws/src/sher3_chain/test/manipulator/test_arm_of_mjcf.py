"""What an MJCF file says of its joints: actuators as laws, forces beside the bodies as MuJoCo's inverse dynamics."""

import re

import mujoco
import numpy as np
import pytest
from drawn_arms import drawn_xml
from sher3_chain.manipulator.bodies import bodies_of_mujoco, read_bodies
from sher3_chain.manipulator.description import ManipulatorDescription
from sher3_chain.manipulator.kind import KIND
from sher3_chain.manipulator.mjcf.drives import Step, driven
from sher3_chain.manipulator.mjcf.joint import drive_joint
from sher3_chain.manipulator.model import arm_model
from sher3_machines import MachineError

XML = """<mujoco><option timestep="0.002" integrator="implicitfast"/><worldbody>
<body><joint name="a" axis="0 1 0" damping="0.5"/><geom size="0.1" mass="2" pos="0.2 0 0"/></body></worldbody>
<actuator>{}</actuator></mujoco>"""


MESHED = """<mujoco><asset><mesh name="m" file="gone.obj"/></asset><worldbody><body>
<joint name="a" axis="0 1 0"/>{}<geom type="mesh" mesh="m"/></body></worldbody></mujoco>"""


def test_meshes_that_are_not_there_are_not_needed_where_masses_are_stated(tmp_path):
    path = tmp_path / "a.xml"
    path.write_text(MESHED.format('<inertial mass="2" pos="0.1 0 0" diaginertia="0.1 0.1 0.1"/>'))
    (link,) = read_bodies(path).tree.links
    assert link.name == "a" and link.inertia[0] == pytest.approx(2.0)
    path.write_text(MESHED.format(""))
    with pytest.raises(MachineError, match="Error opening") as refused:
        read_bodies(path)
    assert "<inertial>" in refused.value.remedy


def drive_of(actuators):
    return driven(mujoco.MjModel.from_xml_string(XML.format(actuators)))["a"]


def test_a_position_actuator_is_a_servo_at_its_joint():
    found = drive_of('<position joint="a" kp="100" kv="5" gear="2" forcerange="-30 30"/>')
    drive = found.drive
    assert drive.servo and (drive.position_gain, drive.velocity_gain, drive.limit) == (400.0, 20.0, 60.0)
    assert drive.factor == 0.5  # control 1 asks for half a radian behind a gear of two
    assert found.recorded == pytest.approx(Step(0.002 * 20.0 + 0.001 * 0.5))
    assert found.of_law == pytest.approx(Step(0.001 * (20.0 + 0.5)))


@pytest.mark.parametrize(("step", "gain"), [(0.0002, 5.0), (0.002, 15.0)])
def test_runge_and_kutta_hold_the_control_alone(step, gain):
    """A servo told to follow a line, or a parabola, step by step: by what its force at their beginning is larger.

    Short steps: half a step of damping as inertia, of stiffness as damping. Long ones: as MuJoCo itself does it, with a
    control of every step that puts the place on the course.
    """
    xml = XML.format(f'<position joint="a" kp="100" kv="{gain}" gear="2"/>').replace("implicitfast", "RK4")
    model = mujoco.MjModel.from_xml_string(
        xml.replace("0.002", str(step)).replace("<option", '<option gravity="0 0 0"')
    )
    found = driven(model)["a"]
    inertia = 2.0 * 0.2**2 + 0.4 * 2.0 * 0.1**2  # kg m^2, of a ball at a distance
    for speed, bend in ((1.0, 0.0), (0.0, 2.0)):
        late = 0.5 * step * bend  # its force acts half a step later, at this much more speed
        wanted = (inertia + found.recorded.inertia) * bend + (0.5 + found.recorded.damping) * (speed + late)
        assert force_on_course(model, speed, bend) == pytest.approx(wanted, rel=1e-4)
    first = Step(2.0 * step * gain, 200.0 * step * (1.0 + step * 4.0 * gain / (3.0 * inertia)), 0.5 * step)
    assert found.recorded == pytest.approx(first, rel=20.0 * step * gain)
    assert found.of_law == pytest.approx(Step(late=0.5 * step))


def force_on_course(model, speed, bend):
    """Return the force at place zero, N m, of a joint whose every step ends on a course of a speed and an acceleration.

    After some steps what it began with is forgotten: speeds at the beginning of steps grow by the same from one to the
    next, and the force at the beginning grows with them.
    """
    data, h, forces = mujoco.MjData(model), model.opt.timestep, []
    steps = 400
    times = h * (np.arange(steps + 1) - steps + 1)
    course = speed * times + 0.5 * bend * times**2
    data.qpos[0], data.qvel[0] = course[0], speed + bend * times[0]
    for place in course[1:]:
        ends = []
        for control in (0.0, 1.0):
            trial = mujoco.MjData(model)
            trial.qpos[:], trial.qvel[:], trial.ctrl[:] = data.qpos, data.qvel, control
            mujoco.mj_step(model, trial)
            ends.append(trial.qpos[0])
        data.ctrl[0] = (place - ends[0]) / (ends[1] - ends[0])
        mujoco.mj_forward(model, data)
        forces.append(2.0 * data.actuator_force[0])
        mujoco.mj_step(model, data)
    return forces[-1]


def test_a_motor_is_a_force():
    drive = drive_of('<motor joint="a" gear="-3"/>').drive
    assert not drive.servo and drive.factor == -3.0


@pytest.mark.parametrize(
    ("actuators", "words"),
    [
        ("", "no actuator"),
        ('<motor joint="a"/><position joint="a" kp="1"/>', "2 actuators"),
        ('<general joint="a" dyntype="filter" dynprm="0.1"/>', "dynamics of its own"),
        ('<velocity joint="a" kv="3"/>', "no servo of places"),
    ],
)
def test_what_is_no_law_of_the_control_says_why(actuators, words):
    found = drive_of(actuators)
    assert found.drive is None and words in found.reason


def test_what_a_step_adds_counts_every_actuator_that_brakes():
    found = drive_of('<velocity joint="a" kv="3" gear="2"/>')
    assert found.recorded == pytest.approx(Step(0.002 * 12.0 + 0.001 * 0.5))


def test_a_control_without_a_law_leaves_its_joint_unjudged():
    joint = {"name": "a", "motion": "rotary", "signals": {"position": {}, "command": {"column": "ctrl"}}}
    guesses = []
    drive_joint(joint, drive_of('<velocity joint="a" kv="3"/>'), False, guesses)
    assert "command" not in joint["signals"] and "record efforts" in guesses[0]


@pytest.mark.parametrize("seed", range(4))
def test_forces_are_those_of_mujoco(seed, tmp_path):
    """MuJoCo's own inverse dynamics, where its step adds nothing."""
    xml = re.sub('integrator="[a-zA-Z]+"', 'integrator="RK4"', drawn_xml(np.random.default_rng(seed)))
    (tmp_path / "arm.xml").write_text(xml)
    model = mujoco.MjModel.from_xml_string(xml)
    names = [model.joint(i).name for i in range(model.njnt)]
    signals = {"position": {"column": "q", "unit": "rad"}, "effort": {"column": "f", "unit": "N*m"}}
    joint = {"motion": "rotary", "signals": signals, "encoder_resolution": 1e-5}
    data = {"kind": "manipulator", "name": "arm", "model": str(tmp_path / "arm.xml"), "time": {"rate": 100.0}}
    described = ManipulatorDescription.model_validate({**data, "joints": [{"name": n, **joint} for n in names]})
    arm = KIND.machine(described).model
    q, v, a = np.random.default_rng(9).normal(size=(3, 5, len(names)))
    state, wanted = mujoco.MjData(model), []
    for qi, vi, ai in zip(q, v, a, strict=True):
        state.qpos[:], state.qvel[:], state.qacc[:] = qi, vi, ai
        mujoco.mj_inverse(model, state)
        wanted.append(state.qfrc_inverse + state.qfrc_constraint)
    np.testing.assert_allclose(arm.needed(q, v, a) + arm.losses.in_motion(q, v), wanted, atol=1e-8)


def test_a_stated_damping_stands_in_place_of_the_model_s(tmp_path):
    (tmp_path / "arm.xml").write_text(XML.format(""))
    signals = {"position": {"column": "q", "unit": "rad"}, "effort": {"column": "f", "unit": "N*m"}}
    joint = {"name": "a", "motion": "rotary", "signals": signals, "encoder_resolution": 1e-5, "viscous": 0.1}
    data = {"kind": "manipulator", "name": "arm", "model": str(tmp_path / "arm.xml"), "time": {"rate": 100.0}}
    arm = KIND.machine(ManipulatorDescription.model_validate({**data, "joints": [joint]})).model
    np.testing.assert_allclose(arm.losses.in_motion(np.zeros((1, 1)), np.ones((1, 1))), 0.0)


@pytest.mark.parametrize("held", [0.0, 0.25])
def test_a_spring_is_no_weight_and_compensation_takes_weight_off(held):
    """A ball of 2 kg at 0.2 m behind a plumb joint, which holds none of it, and a level one."""
    joints = f'<body gravcomp="{held}"><joint name="b" stiffness="9"/><joint name="a"'
    source = mujoco.MjModel.from_xml_string(XML.format("").replace('<body><joint name="a"', joints))
    model = arm_model(bodies_of_mujoco(source, "arm"), ["b", "a"], None)
    q = np.array([[0.5, 0.3], [-1.0, 1.2]])
    weight = model.weight(q)
    assert (weight[:, 0] == 0.0).all()
    np.testing.assert_allclose(weight[:, 1], -(1.0 - held) * 2.0 * 9.81 * 0.2 * np.cos(q[:, 1]), rtol=1e-9)
    np.testing.assert_allclose(model.needed(q, 0.0 * q, 0.0 * q)[:, 0], 9.0 * q[:, 0], rtol=1e-9)
