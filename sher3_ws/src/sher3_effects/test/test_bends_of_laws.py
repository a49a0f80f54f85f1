"""Where laws bend: teeth, springs of two slopes, compliances that stiffen, ratios along the travel."""

import numpy as np
import pytest
from sher3_effects.compliance.stiffening import softness, stiffened
from sher3_effects.compliance.two_slopes import is_shown, knees, parts, slopes
from sher3_effects.periodic.phase import orders_of
from sher3_effects.scale.varying_ratio import gentle, lines, mean_ratio


def test_orders_of_teeth():
    assert orders_of({"periods_per_rev": 4.0}) == [4.0]
    assert orders_of({"periods_per_rev": 4.0, "unlike": 1.0}) == [4.0, 3.0, 5.0, 2.0, 6.0, 1.0, 7.0, 8.0, 12.0]


def test_orders_of_few_teeth_are_positive_and_each_stands_once():
    assert orders_of({"periods_per_rev": 1.0, "unlike": 1.0}) == [1.0, 2.0, 3.0, 4.0]


def test_a_compliance_falls_to_half_at_its_force():
    """It is stated at 1 N, where it is 1."""
    force = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 4.0], [0.0, 0.0, 0.0]])
    np.testing.assert_allclose(softness(force, {"stiffens": 4.0})[:, 0, 0], [1.0, 1.25 / 2.0, 1.25])
    np.testing.assert_allclose(softness(force, {})[:, 0, 0], 1.0)
    assert [s["stiffens"] for s in stiffened({"a": 1.0})] == [2.0, 6.0, 20.0]


def test_a_force_is_parted_at_the_knee():
    below, beyond = parts(np.array([-3.0, 1.0, 5.0]), {"knee": 2.0})
    np.testing.assert_allclose(below, [-2.0, 1.0, 2.0])
    np.testing.assert_allclose(beyond, [-1.0, 0.0, 3.0])
    assert len(parts(np.zeros(3), {})) == 1
    assert slopes({"knee": 2.0}, np.array([0.1, 0.04])) == {"knee": 2.0, "stiffness_beyond": pytest.approx(25.0)}


def test_knees_lie_where_forces_pass_and_not_between_two_loads():
    ramp = np.linspace(-1.0, 1.0, 401)
    usual = 1.0 / np.sqrt(3.0)
    assert knees([ramp], {})[0]["knee"] == pytest.approx(0.3 * usual, rel=0.01)
    assert all(shape["knee"] > 1.0 for shape in knees([np.repeat([0.0, 1.0], 100)], {}))
    assert is_shown({"knee": 0.7, "least": 1.0}) and not is_shown({"knee": 0.6, "least": 1.0})


def test_a_ratio_that_varies_adds_hats_between_the_ends():
    shape = {"middle": 0.0, "half": 2.0}
    columns = lines(np.array([-2.0, 0.0, 2.0]), shape)
    assert len(columns) == 8
    np.testing.assert_allclose(columns[4], [0.0, 2.0, 0.0])
    assert gentle(np.array([1.0, 0.5])) and not gentle(np.array([1.0, 0.6]))
    assert mean_ratio(np.array([0.25])) == pytest.approx(0.25)
