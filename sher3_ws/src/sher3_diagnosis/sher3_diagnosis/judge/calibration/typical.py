"""How unlike the labelled cases a cause's evidence is: odds that were learnt elsewhere promise less there."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Mapping

import numpy as np
from pydantic import BaseModel, ConfigDict

from sher3_diagnosis.judge.calibration.logistic import Logistic

RARE = 0.1
"""Share of the labelled causes as unusual as a cause, below which its odds are held back."""
LEAST_TRUST = 0.5
"""Factor on the evidence's weight where no labelled cause is as unusual."""
RIDGE = 0.05
"""Added to the variances, of inputs with a spread of one: what always varies together must not count for ever."""


class Typical(BaseModel):
    """Where the labelled causes lie.

    Attributes:
        covariance: (p, p) of the inputs of a model, centred and scaled as it does.
        distances: quantiles of the labelled causes' distances from the middle, at even steps from 0 to 1.
        causes: how many they are.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    covariance: tuple[tuple[float, ...], ...]
    distances: tuple[float, ...]
    causes: int

    def typicality(self, model: Logistic, numbers: Mapping[str, float]) -> float:
        """Return the share of the labelled causes that lie at least as far from the middle, 0 to 1."""
        quantiles, steps = self.distances, len(self.distances) - 1
        found = distance(model.scaled(numbers), np.array(self.covariance))
        if not quantiles[0] < found < quantiles[-1]:
            return float(found <= quantiles[0])
        above = bisect_left(quantiles, found)
        part = (found - quantiles[above - 1]) / max(quantiles[above] - quantiles[above - 1], 1e-12)
        return float(1.0 - (above - 1 + part) / steps)


def distance(x: np.ndarray, covariance: np.ndarray) -> float:
    """Return the Mahalanobis distance of scaled inputs (p,) per input that is there (the others are NaN)."""
    known = np.isfinite(x)
    if not known.any():
        return 0.0
    within = covariance[np.ix_(known, known)] + RIDGE * np.eye(int(known.sum()))
    square = float(x[known] @ np.linalg.solve(within, x[known]))  # pairs that are seldom told may make it negative
    return math.sqrt(max(square, 0.0) / int(known.sum()))


def trust(typicality: float | None) -> float:
    """Return the factor on the evidence's weight: one of a usual cause, less of a rare one."""
    if typicality is None:
        return 1.0
    return LEAST_TRUST + (1.0 - LEAST_TRUST) * min(1.0, typicality / RARE)
