"""Serial arms: kinematics from both sources, and joint zeros found from poses measured from outside."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from sher3_gap.machines import MachineError
from sher3_gap.machines.arm_data import ArmData
from sher3_gap.machines.arm_diagnose import diagnose_arm
from sher3_gap.machines.arm_kinematics import arm_of, postures, transform
from sher3_gap.machines.description import ArmMachine

HALF = np.pi / 2
ROWS = [(0.0, 0.3, 0.0), (0.0, 0.0, -HALF), (0.25, 0.0, 0.0), (0.05, 0.28, -HALF), (0.0, 0.0, HALF), (0.0, 0.08, -HALF)]
URDF = """<robot name="two"><link name="base"/><link name="a"/><link name="b"/><link name="tip"/>
<joint name="j1" type="revolute"><parent link="base"/><child link="a"/>
<origin xyz="0 0 0.3" rpy="0 0 0"/><axis xyz="0 0 1"/></joint>
<joint name="j2" type="revolute"><parent link="a"/><child link="b"/>
<origin xyz="0 0 0" rpy="-1.5707963267948966 0 0"/><axis xyz="0 0 1"/></joint>
<joint name="end" type="fixed"><parent link="b"/><child link="tip"/><origin xyz="0.25 0 0.1"/></joint></robot>"""


def arm(rows=ROWS, **more):
    joints = [{"name": f"j{i + 1}", "a": a, "d": d, "alpha": alpha} for i, (a, d, alpha) in enumerate(rows)]
    column = {"column": "x", "unit": "rad"}
    base = {"kind": "arm", "name": "arm", "joint_positions": column, "poses": {"column": "p", "unit": "m"}}
    return ArmMachine.model_validate({**base, "noise": 2e-4, "joints": joints, **more})


def measured(offsets, n=80, seed=0, noise=2e-4):
    rng = np.random.default_rng(seed)
    q = rng.uniform(-1.2, 1.2, (n, len(ROWS)))
    true = postures(arm_of(arm()), q - offsets).tip
    z = transform([0.4, -0.2, 0.1], Rotation.from_euler("xyz", [0.3, -0.2, 1.0]).as_matrix())
    x = transform([0.02, 0.05, 0.06], Rotation.from_euler("xyz", [0.1, 0.2, -0.7]).as_matrix())
    poses = z @ true @ x
    poses[:, :3, 3] += noise * rng.normal(size=(n, 3))
    return ArmData("run", q, poses)


def test_urdf_and_dh_agree(tmp_path):
    path = tmp_path / "two.urdf"
    path.write_text(URDF)
    q = np.random.default_rng(1).uniform(-1, 1, (5, 2))
    by_urdf = postures(arm_of(arm((), urdf=path, base_link="base", tip_link="tip")), q).tip
    by_dh = postures(arm_of(arm(ROWS[:2])), q).tip @ transform([0.25, 0.0, 0.1])
    np.testing.assert_allclose(by_urdf, by_dh, atol=1e-12)
    with pytest.raises(MachineError, match="no chain"):
        arm_of(arm((), urdf=path, base_link="base", tip_link="hand"))


def test_nominal_arm_has_no_gap():
    verdict = diagnose_arm(arm(), [measured(np.zeros(6))], (), lambda _: None)
    assert verdict.status == "no_gap", verdict


def test_joint_zeros_are_found():
    offsets = np.array([0.0, 0.008, 0.0, -0.006, 0.0, 0.0])
    verdict = diagnose_arm(arm(), [measured(offsets)], (), lambda _: None)
    assert verdict.status == "attributed"
    found = {c.actuator: c.parameters["offset"].value for c in verdict.causes if c.effect == "encoder_offset"}
    assert found == {"j2": pytest.approx(0.008, abs=1e-3), "j4": pytest.approx(-0.006, abs=1e-3)}
    assert verdict.closure.stage.value > 0.95


def test_wrong_number_of_joints_is_named():
    with pytest.raises(MachineError, match="do not fit the arm"):
        diagnose_arm(arm(ROWS[:5]), [measured(np.zeros(6))], (), lambda _: None)
