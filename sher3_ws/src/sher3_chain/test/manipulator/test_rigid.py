"""Trees of rigid bodies against Pinocchio, which shares no code with them."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest
from sher3_chain.manipulator.bodies import bodies_of
from sher3_chain.manipulator.model import ArmModel, arm_model
from sher3_machines import MachineError

SAMPLES, JOINTS = 40, 8
KINDS = ("revolute", "continuous", "prismatic", "fixed")


def three(rng: np.random.Generator, size: float) -> str:
    return " ".join(f"{x:.6f}" for x in size * rng.normal(size=3))


def drawn(seed: int) -> str:
    """Return a URDF of a random tree: branches, fixed links, skewed axes, full inertias."""
    rng = np.random.default_rng(seed)
    links, joints = ['<link name="base"/>'], []
    for i in range(JOINTS):
        half = rng.normal(size=(3, 3))
        about = 0.01 * (np.eye(3) * np.trace(half @ half.T) - half @ half.T)
        six = " ".join(f'i{"xyz"[r]}{"xyz"[c]}="{about[r, c]:.8f}"' for r in range(3) for c in range(r, 3))
        inertial = f'<origin xyz="{three(rng, 0.1)}" rpy="{three(rng, 1)}"/><mass value="{rng.uniform(0.1, 3):.5f}"/>'
        links.append(f'<link name="l{i}"><inertial>{inertial}<inertia {six}/></inertial></link>')
        parent = "base" if i == 0 else f"l{rng.integers(max(0, i - 2), i)}"
        ends = f'<origin xyz="{three(rng, 0.3)}" rpy="{three(rng, 1)}"/><parent link="{parent}"/><child link="l{i}"/>'
        limit = '<limit lower="-3" upper="3" effort="9" velocity="9"/>'
        kind = KINDS[i % 2 if i < 2 else rng.integers(4)]
        joints.append(f'<joint name="j{i}" type="{kind}">{ends}<axis xyz="{three(rng, 1)}"/>{limit}</joint>')
    return "<robot name='r'>" + "".join(links + joints) + "</robot>"


def of_pinocchio(text: str, names, q, v, a):
    """Forces, regressor times parameters, and inertia matrix at the first sample, of the joints by name."""
    model = pin.buildModelFromXML(text)
    locked = [j for j in range(1, model.njoints) if model.names[j] not in names]
    model = pin.buildReducedModel(model, locked, pin.neutral(model))
    data, rows = model.createData(), [model.joints[model.getJointId(n)].idx_v for n in names]
    forces, order = [], np.argsort(rows)
    for qi, vi, ai in zip(q[:, order], v[:, order], a[:, order], strict=True):
        forces.append(pin.rnea(model, data, pin.integrate(model, pin.neutral(model), qi), vi, ai)[rows])
    upper = np.triu(pin.crba(model, data, pin.integrate(model, pin.neutral(model), q[0, order])))
    return np.array(forces), (upper + np.triu(upper, 1).T)[np.ix_(rows, rows)]


def judged(text: str, seed: int) -> tuple[ArmModel, tuple[np.ndarray, ...]]:
    """Return a model of some joints in any order, and a motion of them."""
    rng = np.random.default_rng(seed)
    bodies = bodies_of(text, "drawn")
    every = list(bodies.joints)
    names = list(rng.permutation(every))[: max(2, len(every) - 2)]
    return arm_model(bodies, names, None), tuple(rng.normal(size=(3, SAMPLES, len(names))))


@pytest.mark.parametrize("seed", range(12))
def test_a_drawn_tree_is_pinocchio_s(seed):
    text = drawn(seed)
    model, motion = judged(text, seed)
    forces, matrix = of_pinocchio(text, model.names, *motion)
    np.testing.assert_allclose(model.needed(*motion), forces, atol=1e-10)
    np.testing.assert_allclose(model.regressor(*motion) @ model.inertial, forces, atol=1e-10)
    np.testing.assert_allclose(model.inertia_matrix(motion[0][0]), matrix, atol=1e-10)


@pytest.mark.parametrize("seed", range(4))
def test_mujoco_s_reading_of_it_needs_the_same_forces(seed):
    text = drawn(seed).replace("<robot name='r'>", "<robot name='r'><mujoco><compiler fusestatic='false'/></mujoco>")
    model, motion = judged(text, seed)
    source = mujoco.MjModel.from_xml_string(text)
    data, joints = mujoco.MjData(source), [source.joint(n) for n in model.names]
    for q, v, a, force in zip(*motion, model.needed(*motion), strict=True):
        for j, *values in zip(joints, q, v, a, strict=True):
            data.qpos[j.qposadr[0]], data.qvel[j.dofadr[0]], data.qacc[j.dofadr[0]] = values
        source.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
        mujoco.mj_inverse(source, data)
        assert data.qfrc_inverse[[j.dofadr[0] for j in joints]] == pytest.approx(force, abs=1e-5)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('link="l0"', 'link="none"', "names a link that is not there"),
        ('<child link="l7"/>', '<child link="l6"/>', "link l6 has two parents"),
        ('<parent link="base"/>', '<parent link="l7"/>', "joints form a loop|two parents"),
        ("<mass value=", "<mass volume=", "has no 'value'"),
        ('rpy="', 'rpy="a ', "rpy of <origin>"),
        ("<robot name='r'>", "<robot name='r' xmlns:xacro='http://x'><xacro:macro/>", "holds macros"),
        ("robot", "sdf", "cannot be read"),
    ],
)
def test_a_file_that_is_no_tree_is_refused_with_what_is_wrong(old, new, words):
    with pytest.raises(MachineError, match=words):
        bodies_of(drawn(0).replace(old, new), "drawn")


ARM_AND_CUBE = """<mujoco><worldbody><body><joint name="hinge" axis="0 1 0"/>
<geom type="capsule" fromto="0 0 0 .3 0 0" size=".02"/></body><body pos="1 0 1"><freejoint name="cube"/>
<geom size=".02"/>{more}</body></worldbody></mujoco>"""


def test_a_thing_to_be_grasped_does_not_stand_in_the_way():
    assert list(bodies_of(ARM_AND_CUBE.format(more=""), "scene").joints) == ["hinge"]


def test_a_robot_that_floats_is_refused():
    leg = '<body><joint name="leg"/><geom size=".01"/></body>'
    with pytest.raises(MachineError, match="leg neither turns nor slides"):
        bodies_of(ARM_AND_CUBE.format(more=leg), "scene")
