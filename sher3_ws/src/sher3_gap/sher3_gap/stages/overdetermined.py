"""Overdetermined part of a set of equations, and which faults it cannot isolate from one another.

Coarse decomposition of Dulmage and Mendelsohn (1958); detectability and isolability after Krysander and Frisk, "Sensor
placement for fault diagnosis" (2008).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

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
    row_of_unknown = np.full(columns, -1)
    matched = np.array([_matched(row, unknowns, row_of_unknown, set()) for row in range(rows)], dtype=bool)
    reached, front = ~matched, np.flatnonzero(~matched)
    while front.size:
        neighbours = row_of_unknown[unknowns[front].any(axis=0)]
        front = np.unique(neighbours[~reached[neighbours]])
        reached[front] = True
    return reached


def _matched(row: int, unknowns: Mask, row_of_unknown: NDArray[np.int64], tried: set[int]) -> bool:
    """Give an equation an unknown of its own, moving others along an augmenting path; whether there is one.

    A row without one never gets one later (Kuhn, 1955), so that the rows may be taken in turn. A score of equations
    needs no library: SciPy's graphs take 0.4 s to import.
    """
    for unknown in np.flatnonzero(unknowns[row]).tolist():
        if unknown not in tried:
            tried.add(unknown)
            owner = int(row_of_unknown[unknown])
            if owner < 0 or _matched(owner, unknowns, row_of_unknown, tried):
                row_of_unknown[unknown] = row
                return True
    return False


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
