"""Requests that cannot be met are refused with the part, the distance and a remedy; nothing is returned."""

import numpy as np
import pytest
from sher3_kinematics import BadInput, InverseVelocity, OutsideLimits, RobotKinematics, Unreachable

DOWN = [0.0, 0.0, -1.0]


@pytest.fixture
def tip(kinematics: RobotKinematics) -> np.ndarray:
    return kinematics.transform_tip_to_base(np.zeros(5))[:3, 3]


@pytest.mark.parametrize(
    ("shift", "axis", "part", "unit", "distance"),
    [
        ([0.0, 0.0, 0.5], DOWN, "delta_1", "m", None),
        ([0.0, 0.04, 0.0], DOWN, "delta_3", "m", None),
        ([0.0, 0.0, 0.0], [0.0, 1.0, -0.1], "roll", "rad", np.arctan2(1.0, 0.1) - np.pi / 4),
        ([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], "roll", "rad", 3 * np.pi / 4),
        ([0.0, 0.0, 0.0], [-1.0, 0.0, -0.2], "tilt", "rad", None),
        ([0.0, 0.0, 0.0], [1.0, 0.0, -0.2], "tilt", "rad", None),
        ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], "tilt", "rad", None),
    ],
)
def test_unreachable_pose(
    kinematics: RobotKinematics,
    tip: np.ndarray,
    shift: list[float],
    axis: list[float],
    part: str,
    unit: str,
    distance: float | None,
) -> None:
    with pytest.raises(Unreachable) as caught:
        kinematics.inverse(tip + shift, axis)
    assert (caught.value.part, caught.value.unit) == (part, unit)
    assert caught.value.distance > 0
    assert "into the workspace" in str(caught.value)
    if distance is not None:
        assert caught.value.distance == pytest.approx(distance, abs=1e-3)


def test_pose_at_a_limit_is_reachable(kinematics: RobotKinematics) -> None:
    for q in ([0, 0, 0, kinematics.upper[3], 0], [0, 0, 0, 0, kinematics.lower[4]], [0.038, 0.038, 0.038, 0, 0]):
        transform = kinematics.transform_tip_to_base(q)
        assert np.abs(kinematics.inverse(transform[:3, 3], -transform[:3, 2]) - q).max() < 1e-12


def test_pose_beyond_a_limit_is_refused_by_its_distance(kinematics: RobotKinematics) -> None:
    transform = kinematics.transform_tip_to_base([0.0381, 0.0381, 0.0381, 0, 0])
    with pytest.raises(Unreachable) as caught:
        kinematics.inverse(transform[:3, 3], DOWN)
    assert caught.value.distance == pytest.approx(1e-4, rel=0.2)


@pytest.mark.parametrize("bad", [[0, 0, 0], [0, 0, 0, 0, np.nan], [[0] * 5], "abcde", None, [0, 0, np.inf, 0, 0]])
def test_bad_actuator_positions(kinematics: RobotKinematics, bad: object) -> None:
    for method in (kinematics.transform_tip_to_base, kinematics.jacobian, kinematics.gravity_load):
        with pytest.raises(BadInput):
            method(bad)  # type: ignore[arg-type]


def test_axis_without_direction(kinematics: RobotKinematics, tip: np.ndarray) -> None:
    with pytest.raises(BadInput, match="no direction"):
        kinematics.inverse(tip, [0.0, 0.0, 0.0])


def test_no_pose_beyond_the_dead_point(kinematics: RobotKinematics) -> None:
    with pytest.raises(Unreachable, match="dead point"):
        kinematics.transform_tip_to_base([0, 0, 0, 0, 0.04])


def test_outside_limits_names_the_actuator(kinematics: RobotKinematics) -> None:
    with pytest.raises(OutsideLimits) as caught:
        kinematics.require_within_limits([0, 0, 0, -0.9, 0])
    assert caught.value.actuator == "roll"
    assert caught.value.distance == pytest.approx(0.9 - np.pi / 4)


def test_batches_of_unequal_length(kinematics: RobotKinematics) -> None:
    with pytest.raises(BadInput, match="differ in number"):
        kinematics.inverse_batch(np.zeros((2, 3)), np.zeros((3, 3)))
    with pytest.raises(BadInput, match="shape"):
        kinematics.transform_tip_to_base_batch(np.zeros((2, 4)))


def test_bad_period(kinematics: RobotKinematics) -> None:
    with pytest.raises(BadInput):
        InverseVelocity(kinematics, period=0.0)
