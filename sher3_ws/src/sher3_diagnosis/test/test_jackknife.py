"""Standard errors from what a value is without each part of the data."""

import numpy as np
import pytest
from sher3_diagnosis.quantify.jackknife import standard_error


def test_that_of_a_mean_is_the_textbook_one():
    x = np.random.default_rng(4).normal(size=(9, 2))
    without = np.array([np.delete(x, k, axis=0).mean(axis=0) for k in range(len(x))])
    assert standard_error(without) == pytest.approx(x.std(axis=0, ddof=1) / 3.0)
    assert float(standard_error(without[:, 0])) == pytest.approx(x[:, 0].std(ddof=1) / 3.0)
