"""Overdetermined part of a set of equations, and which faults it cannot isolate from one another.

Coarse decomposition of Dulmage and Mendelsohn (1958); detectability and isolability after Krysander and Frisk, "Sensor
placement for fault diagnosis" (2008). The maximum matching is SciPy's.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import maximum_bipartite_matching

Mask = NDArray[np.bool_]


def overdetermined(unknowns: Mask) -> Mask:
    """Return which equations are in the part with more equations than unknowns: those with redundancy.

    These are the equations that alternating paths reach from one that a maximum matching leaves without an unknown.

    Args:
        unknowns: (equations, unknowns), whether an unknown stands in an equation.

    Returns:
        Mask of shape (equations,).
    """
    rows, columns = unknowns.shape
    if not columns:
        return np.ones(rows, dtype=bool)
    unknown_of_row = maximum_bipartite_matching(csr_matrix(unknowns), perm_type="column")
    row_of_unknown = np.full(columns, -1)
    matched = unknown_of_row >= 0
    row_of_unknown[unknown_of_row[matched]] = np.flatnonzero(matched)
    reached, front = ~matched, np.flatnonzero(~matched)
    while front.size:
        neighbours = row_of_unknown[unknowns[front].any(axis=0)]
        front = np.unique(neighbours[~reached[neighbours]])
        reached[front] = True
    return reached


def not_isolable(unknowns: Mask, faults: Mask) -> Mask:
    """Return which fault cannot be isolated from which.

    Fault i is isolable from j when an equation that i breaks is overdetermined without the equations that j breaks.

    Args:
        unknowns: (equations, unknowns), whether an unknown stands in an equation.
        faults: (equations, faults), whether a fault breaks an equation.

    Returns:
        Mask of shape (faults, faults): i cannot be isolated from j.
    """
    confused = np.ones((faults.shape[1],) * 2, dtype=bool)
    for j, broken in enumerate(faults.T):
        left = ~broken
        confused[:, j] = ~faults[left][overdetermined(unknowns[left])].any(axis=0)
    return confused
