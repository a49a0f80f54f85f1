"""A ratio that varies along the travel: a broken line beside the straight line."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.effect import Shape

from sher3_effects.travel import share_of

PARTS = 8
"""Of the travel. A broken line tells nothing of parts that a run does not reach, and so does not go astray there, as a
polynomial does: of orders 3 to 5 it lost 40 times the gap on runs left out that went farther than the others."""
MOST = 0.5
"""Largest distance from the straight line over its own at the end of the travel: beyond it the ratio is hardly off on
the whole."""
NODES = np.linspace(-1.0, 1.0, PARTS + 1)


def lines(position: Array, shape: Shape) -> list[Array]:
    """Return columns (n,): the position; of a ratio that varies a hat over each node beside it, m at its top."""
    if "half" not in shape:
        return [position]
    x = share_of(position, shape)
    return [position, *(shape["half"] * np.interp(x, NODES, hat) for hat in np.eye(PARTS + 1)[1:-1])]


def gentle(coefficients: Array) -> bool:
    """Return whether no node is off the straight line by more than `MOST` times its value at the end of the travel.

    The coefficients (p,) are those of the columns of `lines`.
    """
    return bool(np.abs(coefficients[1:]).max(initial=0.0) <= MOST * abs(coefficients[0]))


def mean_ratio(coefficients: Array) -> float:
    """Return the slope of the straight line nearest to a broken line: coefficients (p,) of the columns of `lines`."""
    beside = np.concatenate([[0.0], coefficients[1:], [0.0]]) if len(coefficients) > 1 else np.zeros_like(NODES)
    return float(coefficients[0] + NODES @ beside / (NODES @ NODES))
