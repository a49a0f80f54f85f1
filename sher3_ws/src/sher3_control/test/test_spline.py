"""The spline of a tip's path beside that of SciPy."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from sher3_control.motion.planned.spline import spline_through


@pytest.mark.parametrize("count", [4, 5, 65])
def test_curve_slope_and_curvature_are_those_of_scipy(count):
    nodes = np.random.default_rng(count).standard_normal((count, 5))
    s = np.linspace(0.0, 1.0, 301)
    ours, theirs = spline_through(nodes), CubicSpline(np.linspace(0.0, 1.0, count), nodes)
    for order in range(3):
        scale = np.abs(theirs(s, order)).max()
        assert np.abs(ours(s, order) - theirs(s, order)).max() < 1e-12 * scale
    assert ours(0.25).shape == (5,) and np.array_equal(ours(1.0), ours(np.array([1.0]))[0])
