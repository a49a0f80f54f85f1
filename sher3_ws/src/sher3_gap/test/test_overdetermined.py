"""Redundancy and isolability of small structures worked out by hand."""

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import maximum_bipartite_matching
from sher3_gap.stages.overdetermined import not_isolable, overdetermined


def table(*rows: str) -> np.ndarray:
    """Return a table of crosses."""
    return np.array([[cross == "x" for cross in row] for row in rows])


@pytest.mark.parametrize(
    ("unknowns", "redundant"),
    [
        (table("x", "x"), [True, True]),  # one quantity read twice
        (table("x"), [False]),  # read once
        (table("xx", "x-", "-x"), [True, True, True]),  # a law and a reading of each of its quantities
        (table("xx", "x-"), [False, False]),  # a law and one reading
        (table("x-", "x-", "-x"), [True, True, False]),  # redundancy of one does not help the other
        (table("xx", "xx", "xx", "--"), [True, True, True, True]),  # nothing unknown in the last one
        (np.zeros((2, 0), dtype=bool), [True, True]),
    ],
)
def test_equations_with_redundancy(unknowns, redundant):
    assert overdetermined(unknowns).tolist() == redundant


def test_the_overdetermined_part_does_not_hang_on_the_order_of_equations_or_on_the_matching():
    rng = np.random.default_rng(0)
    for _ in range(200):
        unknowns = rng.random(tuple(rng.integers(1, 9, 2))) < rng.uniform(0.1, 0.6)
        size = maximum_bipartite_matching(csr_matrix(unknowns), perm_type="column")
        found, order = overdetermined(unknowns), rng.permutation(len(unknowns))
        assert overdetermined(unknowns[order]).tolist() == found[order].tolist()
        assert found[size < 0].all()  # what one maximum matching leaves over has redundancy, whichever it is


def test_two_readings_show_a_fault_and_three_say_in_which():
    faults = np.eye(3, dtype=bool)
    two = not_isolable(table("x", "x"), faults[:2, :2])
    assert two.all()
    three = not_isolable(table("x", "x", "x"), faults)
    assert three.tolist() == np.eye(3, dtype=bool).tolist()
