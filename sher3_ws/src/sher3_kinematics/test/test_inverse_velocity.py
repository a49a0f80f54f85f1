"""Velocity limits: direction kept, acceleration kept, and a stop before every end of travel and of the workspace."""

import numpy as np
import pytest
from sher3_kinematics import BadInput, InverseVelocity, RobotKinematics
from sher3_kinematics.kernel import velocity as kernel_velocity

PERIOD = 0.002


@pytest.fixture(scope="module", params=[1, 3], ids=["acts at once", "acts two periods late"])
def inverse_velocity(request: pytest.FixtureRequest, kinematics: RobotKinematics) -> InverseVelocity:
    return InverseVelocity(kinematics, reaction_periods=request.param)


def run(inverse_velocity: InverseVelocity, q: np.ndarray, twist: np.ndarray, ticks: int) -> np.ndarray:
    """Drive a robot that executes each command after the reaction time; return positions and commands (n, 2, 5)."""
    late = round(inverse_velocity.reaction / inverse_velocity.period) - 1
    pending, previous, history = [np.zeros(5)] * late, np.zeros(5), []
    for _ in range(ticks):
        previous = inverse_velocity(q, twist, previous).q_dot
        pending.append(previous)
        q = q + pending.pop(0) * inverse_velocity.period
        history.append((q, previous))
    return np.array(history)


def test_stops_before_every_end(
    kinematics: RobotKinematics, inverse_velocity: InverseVelocity, workspace_q: np.ndarray
) -> None:
    """Constant twists from all over the workspace, held until the robot has come to rest at some end."""
    rng = np.random.default_rng(11)
    seen = set()
    for q in 0.7 * workspace_q[:60]:
        twist = rng.normal(size=6) * [0.02, 0.02, 0.02, 0.5, 0.5, 0.5]
        history = run(inverse_velocity, q, twist, 2500)
        positions, commands = history[:, 0], history[:, 1]
        assert (positions <= kinematics.upper).all()
        assert (positions >= kinematics.lower).all()
        centres = kinematics.delta.forward_batch(np.ascontiguousarray(positions[::50, :3]))
        assert min(kinematics.delta.edge_distance(centre) for centre in centres) >= -1e-15
        steps = np.abs(np.diff(commands, axis=0)) / PERIOD
        assert (steps <= kinematics.acceleration * (1 + 1e-9)).all()
        assert (np.abs(commands) <= kinematics.velocity * (1 + 1e-12)).all()
        seen.add(inverse_velocity(positions[-1], twist, np.zeros(5)).limited_by.split(" ")[0])
    assert {"travel", "reach"} <= seen


def test_direction_is_kept_under_velocity_and_braking_limits(
    kinematics: RobotKinematics, workspace_q: np.ndarray
) -> None:
    """Once up to speed, the command is parallel to the wanted velocity, whatever scales it."""
    inverse_velocity = InverseVelocity(kinematics, reaction_periods=1)
    rng = np.random.default_rng(12)
    for q in 0.7 * workspace_q[:40]:
        wanted = rng.normal(size=5) * kinematics.velocity * 3
        scale = inverse_velocity.limit(q, wanted, np.zeros(5)).scale
        result = inverse_velocity.limit(q, wanted, scale * wanted)
        assert np.abs(result.q_dot - scale * wanted).max() < 1e-12
        assert 0 < scale < 1


def test_braking_distance_is_used(kinematics: RobotKinematics) -> None:
    """The robot does not stop short: it comes within a millidegree and a micrometre of the end it is sent to."""
    inverse_velocity = InverseVelocity(kinematics, reaction_periods=1)
    for k, wanted in ((3, [0, 0, 0, 1.0, 0]), (4, [0, 0, 0, 0, 0.01])):
        q, previous = np.zeros(5), np.zeros(5)
        for _ in range(2500):
            previous = inverse_velocity.limit(q, wanted, previous).q_dot
            q = q + previous * PERIOD
        assert 0 <= kinematics.upper[k] - q[k] < 1e-6


def test_moving_away_from_an_end_is_free(kinematics: RobotKinematics) -> None:
    inverse_velocity = InverseVelocity(kinematics)
    q = np.array([0, 0, 0, kinematics.upper[3] + 0.001, 0])
    inwards = inverse_velocity.limit(q, [0, 0, 0, -0.01, 0], np.zeros(5))
    assert inwards.scale == 1.0
    assert inwards.q_dot[3] == pytest.approx(-0.01)
    outwards = inverse_velocity.limit(q, [0, 0.001, 0, 0.01, 0], np.zeros(5))
    assert outwards.scale == 0.0
    assert not outwards.q_dot.any()
    assert outwards.limited_by == "travel of roll"


def test_limits_are_named(kinematics: RobotKinematics) -> None:
    inverse_velocity = InverseVelocity(kinematics)
    fast = inverse_velocity.limit(np.zeros(5), [0, 1.0, 0, 0, 0], np.zeros(5))
    assert fast.limited_by == "velocity of delta_2"
    assert fast.scale == pytest.approx(0.0122)
    step = inverse_velocity.limit(np.zeros(5), [0, 0.01, 0, 0, 0], np.zeros(5))
    assert step.limited_by == "acceleration"
    assert step.q_dot[1] == pytest.approx(1.83 * PERIOD)
    assert inverse_velocity.limit(np.zeros(5), np.zeros(5), np.zeros(5)).limited_by == ""


def test_twist_that_is_not_finite_is_refused(kinematics: RobotKinematics) -> None:
    inverse_velocity = InverseVelocity(kinematics)
    with pytest.raises(BadInput):
        inverse_velocity(np.zeros(5), [0, 0, np.nan, 0, 0, 0], np.zeros(5))


def test_impossible_configuration_gives_zero(kinematics: RobotKinematics) -> None:
    """At a reading for which no platform position exists the velocity is zero, not an exception in the loop."""
    result = InverseVelocity(kinematics)([0, 0, 0.3, 0, 0], [0.001] * 6, [0.001] * 5)
    assert not result.q_dot.any()
    assert result.limited_by == "a value that is not finite"


def test_an_actuator_on_its_way_to_an_end_is_held_to_its_own_braking(kinematics: RobotKinematics) -> None:
    """Braking to rest at the acceleration limit would overrun an end 10 um away: then the end counts more."""
    inverse = InverseVelocity(kinematics, reaction_periods=1.0)
    for sign, ends in ((1.0, inverse.limits[1]), (-1.0, inverse.limits[0])):
        for k in range(5):
            q, previous = np.zeros(5), np.zeros(5)
            room, fast = (1e-5, 0.01) if k != 3 else (1e-3, 1.0)
            q[k], previous[k] = ends[k] - sign * room, sign * fast
            q_dot = inverse.limit(q, np.zeros(5), previous).q_dot
            assert 0.0 <= sign * q_dot[k] * inverse.period <= room


def test_the_kernel_answers_a_number_that_is_none_with_rest(kinematics: RobotKinematics) -> None:
    """The arguments of the control loop have been judged; should one slip through, nothing moves."""
    inverse, p = InverseVelocity(kinematics), kinematics.parameters
    for position in range(3):
        for bad in (np.nan, np.inf):
            vectors = [np.zeros(5), np.full(5, 1e-3), np.zeros(5)]
            vectors[position][2] = bad
            q_dot = np.full(5, 7.0)
            arguments = (inverse.limits, 0.1, inverse.period, inverse.reaction, q_dot)
            assert kernel_velocity.limit_velocity_into(p, *vectors, *arguments) == (0.0, kernel_velocity.NOT_FINITE)
            assert not q_dot.any()
