"""Boosted trees: a step by hand, and tree for tree those of scikit-learn."""

import numpy as np
import pytest
from sher3_diagnosis.fit.trees import Growth, bin_edges, boosted

FEW = Growth(trees=25, rate=0.2, leaves=8, bins=32, ridge=5.0)
"""Of the free laws."""
MANY = Growth(trees=80, rate=0.12, leaves=31, bins=255, ridge=0.0)
"""Of the ceiling of a discovery."""


def test_one_tree_of_two_leaves_by_hand():
    """Mean 0.5; half of each side's -+0.5, held down as if five more samples of the mean were in its leaf of 20."""
    x = np.repeat([0.0, 1.0], 20)[:, None]
    step = Growth(trees=1, rate=0.5, leaves=8, bins=32, ridge=5.0)
    predicted = boosted(x, x[:, 0], np.array([[-3.0], [0.5], [0.6]]), step)
    assert predicted == pytest.approx([0.5 - 0.5 * 10 / 25, 0.5 - 0.5 * 10 / 25, 0.5 + 0.5 * 10 / 25])


def test_a_leaf_has_twenty_samples():
    x = np.repeat([0.0, 1.0], [19, 21])[:, None]
    assert boosted(x, x[:, 0], x, FEW) == pytest.approx(21 / 40)


def test_edges_are_middles_of_few_values_and_quantiles_of_many():
    assert bin_edges(np.array([3.0, 1.0, 1.0, 2.0]), 4).tolist() == [1.5, 2.5, np.inf]
    assert bin_edges(np.arange(8.0), 4).tolist() == [1.5, 3.5, 5.5]
    assert bin_edges(np.arange(5.0), 4).tolist() == [1.0, 2.0, 3.0]
    assert bin_edges(np.ones(5), 3).tolist() == [np.inf, np.inf]


@pytest.mark.parametrize(("growth", "samples"), [(FEW, 45), (FEW, 300), (FEW, 1200), (MANY, 1200)])
def test_they_are_the_trees_of_scikit_learn(growth, samples):
    """Ties included: inputs that mirror, repeat, are constant, or have few values."""
    from sklearn.ensemble import HistGradientBoostingRegressor

    rng = np.random.default_rng(samples)
    x = rng.normal(size=(samples, 7))
    x[:, 1], x[:, 2], x[:, 3], x[:, 4] = np.round(2.0 * x[:, 1]), -x[:, 0], x[:, 0], 0.0
    y, new = np.sin(2.0 * x[:, 0]) + 0.3 * rng.normal(size=samples), rng.normal(size=(400, 7))
    trees = HistGradientBoostingRegressor(
        max_iter=growth.trees,
        learning_rate=growth.rate,
        max_leaf_nodes=growth.leaves,
        max_bins=growth.bins,
        l2_regularization=growth.ridge,
        early_stopping=False,
    )
    assert boosted(x, y, new, growth) == pytest.approx(trees.fit(x, y).predict(new), abs=1e-12)
