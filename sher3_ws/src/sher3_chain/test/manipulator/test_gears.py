"""Joints that follow others by gears: positions by the gear, forces by virtual work."""

import mujoco
import numpy as np
import pytest
from sher3_chain.manipulator.bodies import bodies_of
from sher3_chain.manipulator.model import arm_model

LINK = """<link name="l{i}"><inertial><origin xyz="0.1 0.02 0.0{i}"/><mass value="{i}"/>
<inertia ixx="0.01" iyy="0.02" izz="0.03" ixy="0.001" ixz="0.002" iyz="0"/></inertial></link>"""
JOINT = """<joint name="j{i}" type="revolute"><origin xyz="0.3 0 0.1" rpy="0.{i} 0.2 0"/><parent link="l{before}"/>
<child link="l{i}"/><axis xyz="0 0.6 0.8"/>{mimic}</joint>"""


def urdf(**mimics):
    """Four joints in a row; `j2='j1 -1.5 0.3'` lets one follow another."""
    out = '<robot name="r"><link name="l0"/>'
    for i in range(1, 5):
        follow = mimics.get(f"j{i}", "").split()
        mimic = '<mimic joint="{}" multiplier="{}" offset="{}"/>'.format(*follow) if follow else ""
        out += LINK.format(i=i) + JOINT.format(i=i, before=i - 1, mimic=mimic)
    return out + "</robot>"


def test_a_follower_moves_by_its_gear_and_its_force_is_felt_by_the_joint_that_it_follows():
    """Against the same arm whose joints all are free, moved alike."""
    q, v, a = np.random.default_rng(1).normal(size=(3, 20, 2))
    free = arm_model(bodies_of(urdf(), "free"), ["j1", "j2", "j3", "j4"], None)
    text = urdf(j2="j4 -1.5 0.3", j3="j2 2 0.1")  # of a chain of gears: j3 = -3 j4 + 0.7
    found = arm_model(bodies_of(text, "geared"), ["j4", "j1"], None)
    ratios, offsets = np.array([[0.0, 1.0], [-1.5, 0.0], [-3.0, 0.0], [1.0, 0.0]]), np.array([0.0, 0.3, 0.7, 0.0])
    whole = free.needed(q @ ratios.T + offsets, v @ ratios.T, a @ ratios.T) @ ratios
    np.testing.assert_allclose(found.needed(q, v, a), whole, atol=1e-12)
    np.testing.assert_allclose(found.regressor(q, v, a) @ found.inertial, whole, atol=1e-12)


def test_gears_in_a_circle_and_one_whose_leader_was_not_recorded_are_joints_at_rest():
    bodies, guesses = bodies_of(urdf(j2="j3 1 0", j3="j2 1 0", j4="j2 1 0"), "circle"), []
    assert bodies.tree.followers(["j1"]) == {}
    bodies.at_rest(["j1"], guesses)
    assert guesses == ["joints that were not recorded stay at zero: j2, j3, j4"]


GRIPPER = """<mujoco><worldbody><body><joint name="a" type="slide" ref="0.2" frictionloss="1" damping="3"/>
<geom size="0.1" mass="2"/></body><body pos="0 1 0"><joint name="b" type="slide" axis="0 0 1" armature="0.5"/>
<geom size="0.1" mass="3"/></body></worldbody><equality><joint joint1="{ends[0]}" joint2="{ends[1]}"
polycoef="0.05 -2 {bent} 0 0" active="{active}"/></equality>{actuators}</mujoco>"""
MOTOR = '<actuator><motor joint="{joint}"/></actuator>'


def gripper(ends="ab", bent=0, active="true", joint="b"):
    return GRIPPER.format(ends=ends, bent=bent, active=active, actuators=MOTOR.format(joint=joint))


@pytest.mark.parametrize(
    ("ends", "joint", "leader", "ratio", "offset"),
    [("ab", "b", "b", -2.0, 0.25), ("ba", "b", "b", -0.5, 0.225), ("ab", "a", "a", -0.5, 0.125)],
)
def test_an_equality_of_mjcf_is_a_gear_of_the_joint_that_a_control_reaches(ends, joint, leader, ratio, offset):
    """MuJoCo itself keeps the joints there: q1 - ref1 = 0.05 - 2 (q2 - ref2)."""
    text = gripper(ends, joint=joint)
    (follower, gear), *others = bodies_of(text, "gripper").tree.followers([leader]).items()
    assert not others and gear.leader == leader and bodies_of(text, "gripper").drives[leader].drive is not None
    assert (gear.ratio, gear.offset) == (pytest.approx(ratio), pytest.approx(offset))
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.gravity[:] = 0.0
    state = mujoco.MjData(model)
    mujoco.mj_step(model, state, 3000)
    assert state.joint(follower).qpos[0] == pytest.approx(ratio * state.joint(leader).qpos[0] + offset, abs=1e-5)
    assert bodies_of(text, "gripper").drives[follower].reason == "an equality couples it with another joint"


def test_losses_of_a_follower_are_felt_too():
    model = arm_model(bodies_of(gripper(), "gripper"), ["b"], (0.0, 0.0, 0.0))
    one = np.ones((1, 1))
    assert model.rotors == pytest.approx([0.5])
    assert model.needed(0.0 * one, 0.0 * one, one)[0, 0] == pytest.approx(3.0 + 0.5 + 4.0 * 2.0)
    assert model.losses.in_motion(0.0 * one, one)[0, 0] == pytest.approx(4.0 * 3.0)
    assert model.losses.full == pytest.approx([2.0])


@pytest.mark.parametrize("change", [{"bent": 1}, {"active": "false"}])
def test_an_equality_that_is_no_line_or_not_active_is_no_gear(change):
    assert bodies_of(gripper(**change), "gripper").tree.followers(["b"]) == {}
