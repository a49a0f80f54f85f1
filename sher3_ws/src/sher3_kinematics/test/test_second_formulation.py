"""The closed forms against formulations that share no code with them: Pinocchio and numeric loop closure."""

import numpy as np
import pinocchio as pin
import pytest
from scipy.optimize import root
from sher3_description import Robot
from sher3_kinematics import RobotKinematics
from sher3_kinematics.arm import Arm, whole_robot_model
from sher3_kinematics.kernel.parameters import KernelParameters


def test_urdf_model_has_the_tip_pose_jacobian_and_gravity(
    robot: Robot, kinematics: RobotKinematics, workspace_q: np.ndarray
) -> None:
    """The URDF, parsed by Pinocchio, with the platform where our delta puts it and the tilt angle of our linkage."""
    model = whole_robot_model(robot)
    data = model.createData()
    tip = model.getFrameId("t")
    names = ("platform_x", "platform_y", "platform_z", "roll", "tilt_angle")
    index = [model.joints[model.getJointId(name)].idx_v for name in names]
    for q in workspace_q[:50]:
        tilt = kinematics.tilt_linkage.angle(q[4])
        x = np.zeros(model.nq)
        x[index] = [*kinematics.delta.forward(q[:3]), q[3], tilt]
        pin.framesForwardKinematics(model, data, x)
        assert np.abs(data.oMf[tip].homogeneous - kinematics.transform_tip_to_base(q)).max() < 1e-12
        jacobian = pin.computeFrameJacobian(model, data, x, tip, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)[:, index]
        chain = np.zeros((5, 5))
        chain[:3, :3], chain[3, 3] = kinematics.delta.jacobian(q[:3]), 1.0
        chain[4, 4] = 1.0 / kinematics.tilt_linkage.ratio(tilt)
        assert np.abs(jacobian @ chain - kinematics.jacobian(q)).max() < 1e-10
        torque = pin.computeGeneralizedGravity(model, data, x)[index[3:]]
        assert np.abs(torque * [1.0, chain[4, 4]] - kinematics.gravity_load(q)[3:]).max() < 1e-10


def test_arm_model_agrees(robot: Robot, kinematics: RobotKinematics, workspace_q: np.ndarray) -> None:
    arm = Arm(robot)
    for q in workspace_q[:20]:
        angles = [q[3], kinematics.tilt_linkage.angle(q[4])]
        to_base = kinematics.transform_tip_to_base(q)
        to_base[:3, 3] -= kinematics.delta.forward(q[:3])
        assert np.abs(arm.transform_tip_to_platform(angles) - to_base).max() < 1e-12
        assert np.abs(arm.jacobian(angles)[:, 0] - kinematics.jacobian(q)[:, 3]).max() < 1e-12
        assert arm.gravity_torque(angles)[0] == pytest.approx(kinematics.gravity_load(q)[3], abs=1e-12)


def ball_centres(robot: Robot) -> tuple[np.ndarray, np.ndarray]:
    """Return base ball centres at slider height 0 and platform ball centres in {p}, (6, 3), from the circumradii."""
    delta = robot.delta
    base, platform = [], []
    for azimuth in delta.leg_azimuth:
        for side in (-1, 1):
            for radius, out in ((delta.base_radius, base), (delta.platform_radius, platform)):
                turn = azimuth + side * np.arcsin(delta.leg_width / (2 * radius))
                out.append([radius * np.cos(turn), radius * np.sin(turn), 0.0])
    return np.array(base), np.array(platform)


def test_six_links_solved_numerically_give_the_same_platform(
    robot: Robot, kinematics: RobotKinematics, workspace_q: np.ndarray
) -> None:
    """Six links between twelve balls, the platform free in six directions, by a general root finder.

    The balls are placed on circles of the two circumradii: this is what decides between the readings of r_p and r_b.
    """
    base, platform = ball_centres(robot)
    for q in workspace_q[::800]:
        start = kinematics.delta.forward(q[:3])
        moved = base + np.array([[0.0, 0.0, h + robot.delta.slider_zero] for h in np.repeat(q[:3], 2)])

        def residual(pose: np.ndarray, moved: np.ndarray = moved) -> np.ndarray:
            balls = platform @ pin.exp3(pose[3:]).T + pose[:3]
            return (((balls - moved) ** 2).sum(axis=1) - robot.delta.link_length**2) / robot.delta.link_length

        found = root(residual, np.array([*start, 0.0, 0.0, 0.0]) + 0.01, method="hybr", tol=1e-15)
        assert np.abs(residual(found.x)).max() < 1e-14
        assert np.abs(found.x[:3] - start).max() < 1e-11
        assert np.abs(found.x[3:]).max() < 1e-10


def leg_chain(p: KernelParameters, leg: int) -> pin.Model:
    """Return slider, universal joint and link of one leg as a Pinocchio chain whose end is the platform centre."""
    values = p[6 * leg : 6 * leg + 6]
    rail = np.array([values[4], values[5], np.sqrt(1 - values[4] ** 2 - values[5] ** 2)])
    model = pin.Model()
    anchor = pin.SE3(np.eye(3), np.array(values[1:4]))
    slider = model.addJoint(0, pin.JointModelPrismaticUnaligned(rail), anchor, "slider")
    first = model.addJoint(slider, pin.JointModelRX(), pin.SE3.Identity(), "first")
    second = model.addJoint(first, pin.JointModelRY(), pin.SE3.Identity(), "second")
    end = pin.SE3(np.eye(3), np.array([0.0, 0.0, values[0]]))
    model.addFrame(pin.Frame("end", second, end, pin.FrameType.OP_FRAME))
    return model


def leaning_inwards(robot: Robot) -> np.ndarray:
    """Return the universal joints' angles (3, 2) with every leg 30 degrees inwards, where the iteration starts."""
    x, y = 0.5 * np.cos(robot.delta.leg_azimuth), 0.5 * np.sin(robot.delta.leg_azimuth)
    second = np.arcsin(-x)
    return np.array([np.arcsin(y / np.cos(second)), second]).T


@pytest.mark.parametrize("built", [False, True])
def test_pinocchio_closed_chain_gives_the_same_platform(
    robot: Robot, as_built: KernelParameters, workspace_q: np.ndarray, built: bool
) -> None:
    """Three slider-universal-link chains closed at the platform centre by Newton's method on Pinocchio's Jacobians."""
    parameters = as_built._replace(base_x=0.0, base_y=0.0, base_z=0.0) if built else None
    kinematics = RobotKinematics(robot, parameters)
    models = [leg_chain(kinematics.parameters, leg) for leg in range(3)]
    datas = [model.createData() for model in models]
    zeros = np.array(kinematics.parameters)[18:21]
    for q in 0.5 * workspace_q[::400]:
        start = kinematics.delta.forward(q[:3])
        centre, angles = start + 1e-3, leaning_inwards(robot)
        for _ in range(50):
            residual, matrix = np.zeros(9), np.zeros((9, 9))
            for leg, (model, data) in enumerate(zip(models, datas, strict=True)):
                x = np.array([q[leg] + zeros[leg], *angles[leg]])
                pin.framesForwardKinematics(model, data, x)
                jacobian = pin.computeFrameJacobian(model, data, x, 1, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
                rows = slice(3 * leg, 3 * leg + 3)
                residual[rows] = data.oMf[1].translation - centre
                matrix[rows, :3] = -np.eye(3)
                matrix[rows, 3 + 2 * leg : 5 + 2 * leg] = jacobian[:3, 1:]
            step = np.linalg.solve(matrix, -residual)
            centre, angles = centre + step[:3], angles + step[3:].reshape(3, 2)
            if np.abs(step).max() < 1e-15:
                break
        assert np.abs(centre - start).max() < 1e-12
