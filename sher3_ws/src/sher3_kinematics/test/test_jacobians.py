"""Every Jacobian and gradient against finite differences, on the nominal robot and one with every geometric error."""

import numpy as np
from sher3_kinematics import RobotKinematics
from sher3_kinematics import kernel as k

STEP = 1e-6


def twist_by_differences(kinematics: RobotKinematics, q: np.ndarray) -> np.ndarray:
    columns = []
    rotation = kinematics.transform_tip_to_base(q)[:3, :3]
    for axis in np.eye(5):
        ahead = kinematics.transform_tip_to_base(q + STEP * axis)
        behind = kinematics.transform_tip_to_base(q - STEP * axis)
        change = (ahead - behind) / (2 * STEP)
        spin = change[:3, :3] @ rotation.T
        columns.append([*change[:3, 3], spin[2, 1], spin[0, 2], spin[1, 0]])
    return np.array(columns).T


def inner(workspace_q: np.ndarray) -> np.ndarray:
    return 0.6 * workspace_q[:100]


def test_tip_jacobian(any_kinematics: RobotKinematics, workspace_q: np.ndarray) -> None:
    for q in inner(workspace_q):
        difference = any_kinematics.jacobian(q) - twist_by_differences(any_kinematics, q)
        assert np.abs(difference).max() < 1e-6


def test_delta_jacobian(any_kinematics: RobotKinematics, workspace_q: np.ndarray) -> None:
    delta = any_kinematics.delta
    for q in inner(workspace_q)[:, :3]:
        columns = [(delta.forward(q + STEP * e) - delta.forward(q - STEP * e)) / (2 * STEP) for e in np.eye(3)]
        assert np.abs(delta.jacobian(q) - np.array(columns).T).max() < 1e-7


def test_tilt_ratio(any_kinematics: RobotKinematics) -> None:
    linkage = any_kinematics.tilt_linkage
    for angle in np.linspace(-1.0, 1.0, 41):
        slope = (linkage.slider(angle + STEP) - linkage.slider(angle - STEP)) / (2 * STEP)
        assert abs(linkage.ratio(angle) - slope) < 1e-8


def test_gravity_is_the_gradient_of_the_potential(kinematics: RobotKinematics, workspace_q: np.ndarray) -> None:
    """Roll and tilt: gradient of roll_mass and tilt_mass; sliders: moving_mass alone (contract, section 3)."""
    arm = kinematics.robot.arm
    for q in inner(workspace_q)[:20]:
        load = kinematics.gravity_load(q)
        weight = kinematics.robot.delta.moving_mass * 9.81
        assert np.abs(load[:3] - kinematics.delta.jacobian(q[:3])[2] * weight).max() < 1e-12

        def potential(roll: float, slider: float) -> float:
            tilt = kinematics.tilt_linkage.angle(slider)
            cx, cy, cz = arm.tilt_com
            _, y, z = arm.roll_com
            height = arm.d3 - np.sin(tilt) * cx + np.cos(tilt) * cz
            roll_height = np.sin(roll) * y + np.cos(roll) * z
            return 9.81 * (arm.roll_mass * roll_height + arm.tilt_mass * (np.sin(roll) * cy + np.cos(roll) * height))

        by_roll = (potential(q[3] + STEP, q[4]) - potential(q[3] - STEP, q[4])) / (2 * STEP)
        by_tilt = (potential(q[3], q[4] + STEP) - potential(q[3], q[4] - STEP)) / (2 * STEP)
        assert abs(load[3] - by_roll) < 1e-8
        assert abs(load[4] - by_tilt) < 1e-6


def test_inverse_velocity_undoes_the_jacobian(any_kinematics: RobotKinematics, workspace_q: np.ndarray) -> None:
    """A twist the robot can make comes back as the actuator velocities that make it."""
    from sher3_kinematics.inverse_velocity import twist_inverse

    rng = np.random.default_rng(3)
    values = np.array(any_kinematics.parameters)
    for q in inner(workspace_q):
        q_dot = rng.normal(size=5) * [0.01, 0.01, 0.01, 0.3, 0.01]
        recovered = twist_inverse(values, q, any_kinematics.jacobian(q) @ q_dot)
        assert np.abs(recovered - q_dot).max() < 1e-12


def test_uncontrollable_rotation_is_dropped_without_moving_the_tip(
    kinematics: RobotKinematics, workspace_q: np.ndarray
) -> None:
    """Any twist: the tip's linear velocity is exact, the angular one its orthogonal projection."""
    from sher3_kinematics.inverse_velocity import twist_inverse

    rng = np.random.default_rng(4)
    values = np.array(kinematics.parameters)
    for q in inner(workspace_q):
        twist = rng.normal(size=6)
        made = kinematics.jacobian(q) @ twist_inverse(values, q, twist)
        missed = twist - made
        assert np.abs(missed[:3]).max() < 1e-12
        third = np.array([0.0, -np.sin(q[3]), np.cos(q[3])])
        assert np.abs(np.cross(missed[3:], third)).max() < 1e-12


def test_kernels_give_nan_where_there_is_no_solution(kinematics: RobotKinematics) -> None:
    p = kinematics.parameters
    assert np.isnan(k.delta_forward(p, 0.0, 0.0, 0.2)).all()
    assert np.isnan(k.delta_inverse(p, 0.05, 0.0, 0.05)).any()
    assert np.isnan(k.tilt_angle(p, 0.05))
