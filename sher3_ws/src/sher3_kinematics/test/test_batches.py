"""Batches as vector code: their sine and arctangent, odd lengths, robots with a rotated base, and what has no pose."""

from __future__ import annotations

import numpy as np
import pytest
from sher3_common.compiled import compiled_ieee
from sher3_kinematics import RobotKinematics
from sher3_kinematics.kernel.blocks import LANES
from sher3_kinematics.kernel.lanes import direction_angle, sine_cosine
from sher3_kinematics.kernel.robot import pose_inverse, tip_jacobian, tip_pose


@compiled_ieee
def sines(angles, out):
    for i in range(len(angles)):
        out[0, i], out[1, i] = sine_cosine(angles[i])


@compiled_ieee
def directions(y, x, out):
    for i in range(len(y)):
        out[i] = direction_angle(y[i], x[i])


def units(found, expected):
    """Return the largest difference in units in the last place; near zero, of a thousandth."""
    return (np.abs(found - expected) / np.spacing(np.maximum(np.abs(expected), 1e-3))).max()


@pytest.mark.parametrize("reach", [0.1, 7.0, 1000.0])
def test_sine_and_cosine_are_those_of_the_library_to_two_units(reach):
    angles = np.concatenate([np.linspace(-reach, reach, 20_001), [0.0, np.pi / 2, -np.pi, 3 * np.pi / 2]])
    out = np.empty((2, len(angles)))
    sines(angles, out)
    assert units(out[0], np.sin(angles)) <= 2.0 and units(out[1], np.cos(angles)) <= 2.0


def test_a_direction_has_the_angle_of_the_library_in_every_octant_and_on_the_axes():
    angles = np.linspace(-np.pi, np.pi, 20_001)
    y, x = 3.0 * np.sin(angles), 3.0 * np.cos(angles)
    y = np.concatenate([y, [0.0, 1.0, -1.0, 0.0, 1e-300]])
    x = np.concatenate([x, [1.0, 0.0, 0.0, -1.0, 1e-300]])
    out = np.empty(len(y))
    directions(y, x, out)
    assert units(out, np.arctan2(y, x)) <= 2.0
    directions(np.zeros(1), np.zeros(1), out[:1])
    assert np.isnan(out[0])


@pytest.mark.parametrize("count", [0, 1, LANES - 1, LANES, 2 * LANES + 3])
def test_any_number_of_poses(count):
    kinematics = RobotKinematics()
    q = np.random.default_rng(1).uniform(kinematics.lower, kinematics.upper, (count, 5))
    rotations, positions = kinematics.transform_tip_to_base_batch(q)
    jacobians = kinematics.jacobian_batch(q)
    back = kinematics.inverse_batch(positions, -rotations[:, :, 2])
    assert (rotations.shape, positions.shape, back.shape) == ((count, 3, 3), (count, 3), (count, 5))
    for k in range(count):
        rotation, position = tip_pose(kinematics.parameters, q[k])
        np.testing.assert_allclose(rotations[k], rotation, rtol=0, atol=4e-16)
        np.testing.assert_allclose(positions[k], position, rtol=0, atol=1e-16)
        np.testing.assert_allclose(jacobians[k], tip_jacobian(kinematics.parameters, q[k]), rtol=1e-12, atol=1e-13)
        np.testing.assert_allclose(back[k], pose_inverse(kinematics.parameters, position, -rotation[:, 2]), atol=1e-15)


def test_a_rotated_base_goes_pose_by_pose_and_is_the_same():
    nominal = RobotKinematics()
    turned = RobotKinematics(parameters=nominal.parameters._replace(base_x=0.02, base_z=-0.01))
    q = np.random.default_rng(2).uniform(turned.lower, turned.upper, (9, 5))
    rotations, positions = turned.transform_tip_to_base_batch(q)
    for k in range(9):
        rotation, position = tip_pose(turned.parameters, q[k])
        assert np.array_equal(rotations[k], rotation) and np.array_equal(positions[k], position)
        assert np.array_equal(turned.jacobian_batch(q)[k], tip_jacobian(turned.parameters, q[k]))


def test_what_has_no_pose_is_nan_and_leaves_its_neighbours_alone():
    kinematics = RobotKinematics()
    q = np.zeros((5, 5))
    q[1, 0], q[2, 4], q[3, 3] = 1.0, 1.0, np.nan
    _, positions = kinematics.transform_tip_to_base_batch(q)
    assert np.isnan(positions).any(axis=1).tolist() == [False, True, True, True, False]
    assert np.array_equal(positions[0], positions[4])
