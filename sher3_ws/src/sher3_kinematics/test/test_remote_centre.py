"""The virtual remote centre: Jacobian rows, free rates, and drift over a long motion."""

import numpy as np
from sher3_kinematics import RemoteCentre, RobotKinematics
from sher3_kinematics.inverse_velocity import _twist_inverse


def centre_at(kinematics: RobotKinematics, q: np.ndarray, depth: float) -> RemoteCentre:
    transform = kinematics.transform_tip_to_base(q)
    return RemoteCentre(kinematics, transform[:3, 3] + depth * transform[:3, 2])


def test_shaft_point_is_on_the_shaft(kinematics: RobotKinematics) -> None:
    q = np.array([0.001, 0.002, -0.003, 0.2, 0.004])
    shaft = centre_at(kinematics, q, 0.018).shaft_point(q)
    assert abs(shaft.depth - 0.018) < 1e-15
    assert np.abs(shaft.deviation).max() < 1e-15


def test_constraint_rows_are_the_rate_of_the_deviation(kinematics: RobotKinematics) -> None:
    """d/dt of the shaft's distance from the centre, by finite differences along random velocities."""
    rng = np.random.default_rng(21)
    q = np.array([0.001, 0.002, -0.003, 0.2, 0.004])
    centre = centre_at(kinematics, q, 0.018)
    rows, deviation = centre.constraint(q)
    assert np.abs(deviation).max() < 1e-15
    for _ in range(10):
        q_dot, step = rng.normal(size=5), 1e-7
        ahead, behind = centre.shaft_point(q + step * q_dot), centre.shaft_point(q - step * q_dot)
        rate = np.linalg.norm(ahead.deviation - behind.deviation) / (2 * step)
        assert abs(np.linalg.norm(rows @ q_dot) - rate) < 1e-6 * max(rate, 1.0)


def test_twist_keeps_the_constraint_and_gives_the_free_rates(kinematics: RobotKinematics) -> None:
    q = np.array([0.001, 0.002, -0.003, 0.2, 0.004])
    centre = centre_at(kinematics, q, 0.018)
    centre.centre += [1e-4, -2e-4, 1e-4]
    twist = centre.twist(q, 0.1, -0.2, 0.003, gain=10.0)
    q_dot = _twist_inverse(np.array(kinematics.parameters), q, twist)
    rows, deviation = centre.constraint(q)
    assert np.abs(rows @ q_dot + 10.0 * deviation).max() < 1e-12
    assert abs(q_dot[3] - 0.1) < 1e-15
    shaft = centre.shaft_point(q)
    assert abs(shaft.axis @ (centre.jacobian(q) @ q_dot) - 0.003) < 1e-15


def test_drift_over_thirty_degrees_stays_below_one_micrometre(kinematics: RobotKinematics) -> None:
    """Roll and tilt of 30 degrees about a centre 18 mm above the tip, Euler steps of 2 ms, gain 10 1/s."""
    q = np.zeros(5)
    centre = centre_at(kinematics, q, 0.018)
    values, worst, reached = np.array(kinematics.parameters), 0.0, np.zeros(2)
    swing, period = np.radians(30.0), 0.002
    for tick in range(10_000):
        phase = 2 * np.pi * tick * period / 10.0
        rates = swing * 2 * np.pi / 10.0 * np.array([np.cos(phase), np.cos(2 * phase)]) * [1.0, 2.0]
        twist = centre.twist(q, rates[0], rates[1], 0.0, gain=10.0)
        q = q + period * _twist_inverse(values, q, twist)
        worst = max(worst, float(np.linalg.norm(centre.shaft_point(q).deviation)))
        reached = np.maximum(reached, np.abs([q[3], kinematics.tilt_linkage.angle(q[4])]))
    assert np.degrees(reached).min() > 29.5
    assert worst < 1e-6
