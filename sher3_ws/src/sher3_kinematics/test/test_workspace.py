"""Reach, swing, workspace membership and the distance to its edge."""

import numpy as np
import pytest
from sher3_kinematics import BadInput, Delta, RobotKinematics, Unreachable
from sher3_kinematics.kernel.parameters import KernelParameters


def test_reach_and_leg_offset(kinematics: RobotKinematics) -> None:
    """R = sqrt(r_b^2 - w^2/4) - sqrt(r_p^2 - w^2/4): the radii are circumradii."""
    assert kinematics.delta.leg_offset == pytest.approx(0.0325355, abs=1e-7)
    assert kinematics.delta.reach == pytest.approx(0.064 - 0.0325355, abs=1e-7)
    beyond = kinematics.delta.reach + 1e-6
    with pytest.raises(Unreachable):
        kinematics.delta.inverse([-beyond, 0.0, 0.05])
    kinematics.delta.inverse([-beyond + 2e-6, 0.0, 0.05])


def test_swing_is_the_angle_between_legs(kinematics: RobotKinematics) -> None:
    delta = kinematics.delta
    assert np.abs(delta.swing(delta.forward(np.zeros(3)))).max() < 1e-8
    straight_up = delta.swing(delta.forward(np.zeros(3)), axis=np.tile([0.0, 0.0, 1.0], (3, 1)))
    assert np.degrees(straight_up) == pytest.approx([30.56] * 3, abs=0.01)


def sampled_edge_distance(delta: Delta, centre: np.ndarray, directions: np.ndarray, far: float) -> float:
    """Return the shortest way out over many directions, each by bisection on the inverse kinematics alone."""

    def inside(point: np.ndarray) -> bool:
        q = delta.inverse_batch(point[None])[0]
        rise = point[2] - (q + delta.parameters.zero_1)
        return bool(((q >= delta.lower) & (q <= delta.upper) & (rise >= delta.least_elevation * 0.064)).all())

    best = far
    for direction in directions:
        near, out = 0.0, best
        if inside(centre + out * direction):
            continue
        while out - near > 1e-7:
            middle = 0.5 * (near + out)
            near, out = (middle, out) if inside(centre + middle * direction) else (near, middle)
        best = out
    return best


def test_edge_distance_is_the_shortest_way_out(kinematics: RobotKinematics, workspace_q: np.ndarray) -> None:
    rng = np.random.default_rng(5)
    directions = rng.normal(size=(4000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    for q in workspace_q[:12]:
        centre = kinematics.delta.forward(q[:3])
        distance = kinematics.delta.edge_distance(centre)
        sampled = sampled_edge_distance(kinematics.delta, centre, directions, 0.1)
        assert distance <= sampled + 1e-7
        assert sampled <= distance * 1.01 + 1e-5


def test_membership_follows_the_sign(kinematics: RobotKinematics) -> None:
    delta = kinematics.delta
    rng = np.random.default_rng(6)
    points = rng.uniform([-0.05, -0.05, -0.02], [0.05, 0.05, 0.14], (2000, 3))
    q = delta.inverse_batch(points)
    rise = points[:, 2:] - q
    with np.errstate(invalid="ignore"):
        expected = ((q >= delta.lower) & (q <= delta.upper) & (rise >= 0.1 * 0.064)).all(axis=1)
    assert [delta.contains(point) for point in points] == expected.tolist()
    assert 50 < expected.sum() < 1950


def test_outside_the_distance_is_a_lower_bound(kinematics: RobotKinematics) -> None:
    delta = kinematics.delta
    with pytest.raises(Unreachable) as caught:
        delta.require([0.0, 0.04, 0.06])
    assert caught.value.part == "delta_3"
    assert caught.value.distance == pytest.approx(-delta.edge_distance([0.0, 0.04, 0.06]))
    assert not delta.contains([0.0, 0.04 - 0.9 * caught.value.distance, 0.06])


def test_legs_that_do_not_meet_say_by_how_much(kinematics: RobotKinematics) -> None:
    with pytest.raises(Unreachable, match="do not meet") as caught:
        kinematics.delta.forward([0.0, 0.0, 0.2])
    span = 0.2 - caught.value.distance
    q = np.array([0.0, 0.0, 0.2])
    kinematics.delta.forward(q.mean() + (q - q.mean()) * (span - 1e-9) / 0.2)
    with pytest.raises(Unreachable):
        kinematics.delta.forward(q.mean() + (q - q.mean()) * (span + 1e-9) / 0.2)


def test_dead_points(kinematics: RobotKinematics) -> None:
    linkage = kinematics.tilt_linkage
    assert np.degrees(linkage.dead_points) == pytest.approx([-109.47, 81.79], abs=0.01)
    assert [linkage.ratio(angle) for angle in linkage.dead_points] == pytest.approx([0.0, 0.0], abs=1e-9)
    with pytest.raises(Unreachable) as caught:
        linkage.slider(1.5)
    assert caught.value.unit == "rad"
    assert caught.value.distance == pytest.approx(1.5 - linkage.dead_points[1])
    with pytest.raises(Unreachable) as caught:
        linkage.angle(0.03)
    assert caught.value.distance == pytest.approx(0.03 - linkage.travel[1])


def test_singularity_distance_vanishes_at_each_singularity(kinematics: RobotKinematics) -> None:
    tilt = kinematics.singularity_distance([0, 0, 0, 0, kinematics.tilt_linkage.travel[1] - 1e-12])
    assert tilt.part == "tilt"
    assert tilt.distance < 1e-4
    flat = kinematics.delta.inverse([-kinematics.delta.reach + 1e-9, 0.0, 0.05])
    leg = kinematics.singularity_distance([*flat, 0.0, 0.0])
    assert leg.part == "delta_1"
    assert leg.distance < 1e-3
    home = kinematics.singularity_distance(np.zeros(5))
    assert 0.3 < home.distance <= 1.0
    smallest = np.linalg.svd(kinematics.jacobian([*flat, 0.0, 0.0])[:3, :3], compute_uv=False)[-1]
    assert smallest < 1e-2


def test_zero_singularity_distance_without_configuration(kinematics: RobotKinematics) -> None:
    assert kinematics.singularity_distance([0, 0, 0.2, 0, 0]).distance == 0.0


def test_bad_elevation_is_refused(kinematics: RobotKinematics, as_built: KernelParameters) -> None:
    with pytest.raises(BadInput, match="least_elevation"):
        Delta(kinematics.robot, as_built, least_elevation=1.5)
