"""The spline of a path against SciPy's."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from sher3_gap.simulate.spline import through


@pytest.mark.parametrize("samples", [4, 5, 60])
def test_a_spline_is_that_of_scipy(samples):
    rng = np.random.default_rng(samples)
    nodes = np.cumsum(rng.integers(5, 15, samples))
    values = rng.standard_normal((samples, 3))
    at = np.linspace(nodes[0], nodes[-1], 200)
    assert through(nodes, values, at) == pytest.approx(CubicSpline(nodes, values)(at), abs=1e-12)
