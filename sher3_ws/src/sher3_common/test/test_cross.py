"""Cross products beside those of numpy, to the bit, of every shape that the rooms use."""

import numpy as np
import pytest
from sher3_common.numbers.cross import cross, skew

RNG = np.random.default_rng(5)


@pytest.mark.parametrize(
    ("a", "b"), [((7, 3), (7, 3)), ((7, 4, 3), (7, 1, 3)), ((3,), (7, 3))], ids=["pairs", "links", "one with many"]
)
def test_a_product_is_that_of_numpy(a, b):
    x, y = RNG.normal(size=a), RNG.normal(size=b)
    assert np.array_equal(cross(x, y), np.cross(x, y))


def test_the_columns_of_a_matrix_are_products_with_the_axes():
    x, y = RNG.normal(size=(5, 3)), RNG.normal(size=(5, 3))
    assert np.array_equal(-skew(x), np.stack([np.cross(axis, x) for axis in np.eye(3)], axis=-1))
    assert np.allclose((skew(x) @ y[..., None])[..., 0], cross(x, y))
