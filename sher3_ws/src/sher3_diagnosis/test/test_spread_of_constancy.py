"""Whether coefficients hold from one excitation to the next, worked out by hand on one coefficient."""

import numpy as np
import pytest
from sher3_diagnosis.attribute.constancy import Constancy


def constancy(*values: float, weight: float = 100.0) -> Constancy:
    """Runs a a b b that would each fit one of these coefficients, all with the same weight."""
    normal = np.full((4, 1, 1), weight)
    return Constancy(("a", "a", "b", "b"), normal, weight * np.array(values)[:, None])


def test_the_same_coefficient_everywhere_has_no_spread():
    found = constancy(2.0, 2.0, 2.0, 2.0)
    assert found.explained == pytest.approx(1600.0)  # 4 runs of 100 * 2^2
    assert found.spread == pytest.approx(0.0)


def test_a_coefficient_that_differs_between_excitations_explains_more_apart():
    """1 in a and 3 in b: together 2, which explains 400 * 2^2; apart they explain 200 * 1^2 and 200 * 3^2."""
    found = constancy(1.0, 1.0, 3.0, 3.0)
    assert found.explained == pytest.approx(1600.0)
    assert found.spread == pytest.approx(400.0 / 1600.0)
    assert not found.constant


def test_repeats_that_differ_are_no_spread():
    """Means 2 and 4, each of two repeats that are 1 off: apart 200 * 2^2 and 200 * 4^2, together 400 * 3^2."""
    assert constancy(1.0, 3.0, 3.0, 5.0).spread == pytest.approx((4000.0 - 3600.0) / 3600.0)


def test_a_lone_excitation_or_no_coefficient_says_nothing():
    assert not Constancy(("a", "a"), np.ones((2, 1, 1)), np.ones((2, 1))).comparable
    assert not Constancy(("a", "b"), np.zeros((2, 0, 0)), np.zeros((2, 0))).comparable
