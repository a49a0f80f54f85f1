"""Direct calls of compiled functions: the same bits as by way of numba's look-up, wrong arguments refused."""

import numba
import numpy as np
import pytest
from sher3_common.compiled import direct
from sher3_kinematics import InverseVelocity, RobotKinematics
from sher3_kinematics.inverse_velocity import describe


@numba.njit
def scaled(values, factor):
    return (values[0] * factor, values[1] * factor)


def test_a_direct_call_is_the_same_function():
    call = direct(scaled, (1.0, 2.0), 3.0)
    assert call((0.1, -7.0), 0.3) == scaled((0.1, -7.0), 0.3)


def test_a_tuple_of_another_length_and_a_text_are_refused():
    call = direct(scaled, (1.0, 2.0), 3.0)
    with pytest.raises(ValueError):
        call((1.0, 2.0, 3.0), 1.0)
    with pytest.raises((TypeError, ValueError)):
        call((1.0, 2.0), "fast")


def test_what_is_not_compiled_is_called_as_it_is():
    assert direct(max, 1, 2) is max


def test_the_control_loops_inverse_velocity_gives_the_bits_of_the_checked_one():
    inverse = InverseVelocity(RobotKinematics())
    generator = np.random.default_rng(5)
    for _ in range(200):
        q = generator.uniform(-1.0, 1.0, 5) * (2e-3, 2e-3, 2e-3, 0.3, 1e-3)
        twist = generator.normal(0.0, 1.0, 6) * (5e-3, 5e-3, 5e-3, 0.05, 0.05, 0.05)
        previous = generator.normal(0.0, 1e-3, 5)
        checked = inverse(q, twist, previous)
        q_dot, scale, code = inverse.of_finite(tuple(q.tolist()), tuple(twist.tolist()), tuple(previous.tolist()))
        assert np.array_equal(q_dot, checked.q_dot, equal_nan=True)
        assert (scale, describe(code)) == (checked.scale, checked.limited_by)
