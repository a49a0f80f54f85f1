"""Forward and inverse kinematics undo each other over the whole workspace."""

import numpy as np
import pytest
from sher3_kinematics import RobotKinematics
from sher3_kinematics.kernel import batch as batch

EXACT = 1e-12


def test_workspace_sample_is_wide(workspace_q: np.ndarray, kinematics: RobotKinematics) -> None:
    """The sample reaches close to every end, so that the other tests mean what they say."""
    assert len(workspace_q) > 10_000
    span = np.ptp(workspace_q, axis=0) / (kinematics.upper - kinematics.lower)
    assert (span > 0.95).all()
    margins = [kinematics.singularity_distance(q).distance for q in workspace_q[:2000]]
    assert min(margins) < 0.15


def test_robot_round_trip(any_kinematics: RobotKinematics, workspace_q: np.ndarray) -> None:
    rotations, positions = any_kinematics.transform_tip_to_base_batch(workspace_q)
    good = np.isfinite(positions).all(axis=1)
    assert good.mean() > 0.98
    recovered = any_kinematics.inverse_batch(positions[good], np.ascontiguousarray(-rotations[good, :, 2]))
    assert np.abs(recovered - workspace_q[good]).max() <= EXACT


def test_pose_round_trip(any_kinematics: RobotKinematics, workspace_q: np.ndarray) -> None:
    """From pose to actuators to pose: the tip returns to its place and the axis to its direction."""
    rotations, positions = any_kinematics.transform_tip_to_base_batch(workspace_q)
    good = np.isfinite(positions).all(axis=1)
    axes = np.ascontiguousarray(-rotations[good, :, 2])
    q = any_kinematics.inverse_batch(positions[good], axes)
    again, tips = any_kinematics.transform_tip_to_base_batch(q)
    assert np.abs(tips - positions[good]).max() <= EXACT
    assert np.abs(-again[:, :, 2] - axes).max() <= EXACT


def test_scalar_and_batch_agree(kinematics: RobotKinematics, workspace_q: np.ndarray) -> None:
    """To rounding: sine and cosine of a batch are vector code (`kernel.lanes`), off by up to two units at the end."""
    sample = workspace_q[:200]
    rotations, positions = kinematics.transform_tip_to_base_batch(sample)
    jacobians = kinematics.jacobian_batch(sample)
    for k, q in enumerate(sample):
        transform = kinematics.transform_tip_to_base(q)
        assert np.abs(transform[:3, :3] - rotations[k]).max() <= 4e-16
        assert np.abs(transform[:3, 3] - positions[k]).max() <= 1e-16
        assert np.abs(kinematics.jacobian(q) - jacobians[k]).max() <= 1e-15 * np.abs(jacobians[k]).max()
        assert np.abs(kinematics.inverse(transform[:3, 3], -transform[:3, 2]) - q).max() <= EXACT


def test_delta_forward_is_the_contract(kinematics: RobotKinematics) -> None:
    """Inverse: s_k = P_z - sqrt(L^2 - |R e_k - P_xy|^2), written out again here."""
    delta = kinematics.robot.delta
    centre = np.array([0.004, -0.007, 0.061])
    arms = delta.leg_offset * np.array([[np.cos(a), np.sin(a)] for a in delta.leg_azimuth])
    expected = centre[2] - np.sqrt(delta.link_length**2 - ((arms - centre[:2]) ** 2).sum(axis=1)) - delta.slider_zero
    assert np.abs(kinematics.delta.inverse(centre) - expected).max() <= EXACT
    assert np.abs(kinematics.delta.forward(expected) - centre).max() <= EXACT


def test_home_height(kinematics: RobotKinematics) -> None:
    delta = kinematics.robot.delta
    home = [0.0, 0.0, np.sqrt(delta.link_length**2 - delta.leg_offset**2)]
    assert np.abs(kinematics.delta.forward(np.zeros(3)) - home).max() <= EXACT


def test_tilt_round_trip(any_kinematics: RobotKinematics) -> None:
    linkage = any_kinematics.tilt_linkage
    low, high = linkage.dead_points
    angles = np.linspace(low + 1e-3, high - 1e-3, 10_001)
    sliders = np.array([linkage.slider(angle) for angle in angles])
    assert (np.diff(sliders) > 0).all()
    assert max(abs(linkage.angle(q) - angle) for q, angle in zip(sliders, angles, strict=True)) <= EXACT


def test_tilt_is_the_contract(kinematics: RobotKinematics) -> None:
    """x(theta) = r sin(theta) + sqrt(l^2 - (e - r cos(theta))^2), q = x(theta) - x(0), written out again here."""
    r, coupler, e = 0.028, 0.070, 0.014
    theta = 0.7
    x = r * np.sin(theta) + np.sqrt(coupler**2 - (e - r * np.cos(theta)) ** 2)
    zero = np.sqrt(coupler**2 - (e - r) ** 2)
    assert kinematics.tilt_linkage.slider(theta) == pytest.approx(x - zero, abs=EXACT)


def test_quaternions_are_the_rotations(kinematics: RobotKinematics, workspace_q: np.ndarray) -> None:
    rotations, _ = kinematics.transform_tip_to_base_batch(workspace_q)
    x, y, z, w = batch.tip_quaternion_batch(rotations).T
    assert np.abs(x * x + y * y + z * z + w * w - 1).max() < 1e-14
    assert np.abs(2 * (x * z + w * y) - rotations[:, 0, 2]).max() < 1e-14
    assert np.abs(2 * (y * z - w * x) - rotations[:, 1, 2]).max() < 1e-14
    assert np.abs(2 * (x * y + w * z) - rotations[:, 1, 0]).max() < 1e-14
