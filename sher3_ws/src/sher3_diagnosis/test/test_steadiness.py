"""Whether coefficients hold from one excitation to the next, worked out by hand on one coefficient."""

import numpy as np
import pytest
from sher3_diagnosis.attribute.steadiness import Steadiness


def steadiness(*values: float, weight: float = 100.0) -> Steadiness:
    """Runs a a b b that would each fit one of these coefficients, all with the same weight."""
    normal = np.full((4, 1, 1), weight)
    return Steadiness(("a", "a", "b", "b"), normal, weight * np.array(values)[:, None])


def test_the_same_coefficient_everywhere_loses_nothing():
    found = steadiness(2.0, 2.0, 2.0, 2.0)
    assert found.explained == pytest.approx(1600.0)  # 4 runs of 100 * 2^2
    assert found.lost == pytest.approx(0.0)
    assert found.scatter == pytest.approx(0.0)


def test_a_coefficient_that_differs_between_excitations_does_not_transfer():
    """1 in a and 3 in b: together 2, which explains 100 (4 - 4 (2 - 1)^2 / 4 ...): with b's in a the gain of a is lost.

    Of a: 2 * 2 * 200 - 4 * 200 = 0 with the common 2; with b's 3: 2 * 3 * 200 - 9 * 200 = -600. Of b: 2 * 2 * 600 - 800
    = 1600 with 2; with a's 1: 1200 - 200 = 1000. Lost 600 + 600 of the 1600 that are explained.
    """
    found = steadiness(1.0, 1.0, 3.0, 3.0)
    assert found.explained == pytest.approx(1600.0)
    assert found.lost == pytest.approx(1200.0 / 1600.0)


def test_scatter_is_the_spread_between_excitations_over_that_of_repeats():
    """Means 2 and 4: between them 100 * 4 * 1 = 400; within, 4 runs 1 from their mean: 400, over 2 degrees: 200."""
    assert steadiness(1.0, 3.0, 3.0, 5.0).scatter == pytest.approx(400.0 / 200.0)


def test_a_lone_excitation_or_no_coefficient_says_nothing():
    one = Steadiness(("a", "a"), np.ones((2, 1, 1)), np.ones((2, 1)))
    assert (one.scatter, one.lost, one.comparable) == (1.0, None, False)
    none = Steadiness(("a", "b"), np.zeros((2, 0, 0)), np.zeros((2, 0)))
    assert (none.scatter, none.lost, none.comparable) == (1.0, None, False)


def test_an_excitation_that_alone_shows_the_cause_is_not_left_out():
    normal = np.array([100.0, 1.0])[:, None, None]
    found = Steadiness(("a", "b"), normal, np.array([[200.0], [0.0]]))
    alone = (
        2.0 * (200.0 / 101.0) * 0.0 - (200.0 / 101.0) ** 2 - (0.0 - 4.0)
    )  # b, with a's 2 in place of the common 200/101
    assert found.lost == pytest.approx(alone / (200.0**2 / 101.0), rel=1e-6)
