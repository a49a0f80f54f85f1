"""Intervals of shares and of parameters, worked out by hand."""

import pytest
from sher3_challenge.score.intervals import parameter_coverage
from sher3_common.numbers.shares import Z, wilson


def test_wilson_of_a_half_of_four():
    """Centre (0.5 + z²/8) / (1 + z²/4) = 0.5; half width z / (1 + z²/4) · sqrt(1/16 + z²/64)."""
    z2 = Z * Z
    half = Z / (1 + z2 / 4) * (1 / 16 + z2 / 64) ** 0.5
    assert half == pytest.approx(0.34996, abs=1e-5)
    assert wilson(0.5, 4) == pytest.approx((0.5 - half, 0.5 + half))


def test_wilson_of_none_and_all():
    """Of none of n the upper end is z² / (n + z²): 3.8415 / 13.8415 for n = 10; of all it is mirrored."""
    assert wilson(0.0, 10) == pytest.approx((0.0, 0.27753), abs=1e-5)
    assert wilson(1.0, 10) == pytest.approx((0.72247, 1.0), abs=1e-5)


@pytest.mark.parametrize(
    ("true", "stated", "found"),
    [
        ({"width": 5.0}, {"width": {"low": 4.0, "high": 6.0}}, (1, 1)),
        ({"width": 5.0}, {"gap": {"low": 5.5, "high": 6.0}}, (1, 0)),  # by another name, and missed
        ({"force": -2.0}, {"Fc": {"low": 1.5, "high": 2.5}}, (1, 1)),  # a sign is a convention
        ({"width": 5.0}, {"width": {"low": None, "high": None}}, (0, 0)),  # no interval, nothing to judge
        ({"width": 5.0, "mass": 1.0}, {"mass": {"low": 0.0, "high": 2.0}}, (1, 1)),
        ({"width": 5.0}, {}, (0, 0)),
    ],
)
def test_parameters_found_and_inside(true, stated, found):
    assert parameter_coverage({"parameters": true}, {"parameters": stated}) == found
