"""Whether a cause has the same size in every excitation: an effect has, a stand-in for another effect has not.

Letting the coefficients of a cause differ from excitation to excitation explains hardly more when its law is right.
The share it explains more is the parameter's spread, weighted by what each excitation tells of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sher3_diagnosis.channel import Array
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, solve
from sher3_diagnosis.thresholds import CERTAIN, CONSTANT


@dataclass(frozen=True)
class Constancy:
    """How constant one cause is.

    Attributes:
        explained: loss the cause explains with one set of coefficients.
        varying: loss it explains in addition with one set per excitation.
    """

    explained: float
    varying: float

    @property
    def spread(self) -> float:
        """Additional share."""
        return self.varying / max(self.explained, 1.0)

    @property
    def constant(self) -> bool:
        """Whether one set of coefficients does."""
        return self.spread < CONSTANT or self.varying < CERTAIN


def constancy_of(evidence: Evidence, fit: Fit, index: int) -> Constancy:
    """Compare one set of coefficients of a cause with one per excitation, the other causes as fitted."""
    data, term = evidence.data, fit.terms[index]
    offsets = np.cumsum([0, *(t.width for t in fit.terms)])
    normal: dict[str, Array] = {}
    right: dict[str, Array] = {}
    for r, excitation in enumerate(evidence.excitations):
        for channel, x in term.columns[r].items():
            left = data.target[r][channel].copy()
            for j, other in enumerate(fit.terms):
                if channel in other.fixed[r]:
                    left -= other.fixed[r][channel]
                if j != index and channel in other.columns[r]:
                    z = other.columns[r][channel]
                    left -= z @ fit.coefficients[offsets[j] : offsets[j] + z.shape[1]]
            normal[excitation] = normal.get(excitation, 0.0) + x.T @ x
            right[excitation] = right.get(excitation, 0.0) + x.T @ left
    if term.width == 0 or not normal:
        return Constancy(0.0, 0.0)
    together = np.sum(list(right.values()), axis=0)
    explained = float(together @ solve(np.sum(list(normal.values()), axis=0), together))
    apart = sum(float(right[e] @ solve(normal[e], right[e])) for e in normal)
    return Constancy(explained, apart - explained)
