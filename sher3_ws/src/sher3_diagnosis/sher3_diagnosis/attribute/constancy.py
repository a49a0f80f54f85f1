"""Parameter constancy: whether a cause has one size in every excitation.

Letting the coefficients of a cause differ from excitation to excitation explains hardly more when its law is right.
The share it explains more is the parameter's spread, weighted by what each excitation tells of it.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sher3_diagnosis.channel import Array
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, solve
from sher3_diagnosis.thresholds import CERTAIN, CONSTANT


@dataclass(frozen=True)
class Constancy:
    """What each run determines of the coefficients of one cause, the other causes as fitted.

    Attributes:
        excitation: of every run.
        normal: (runs, p, p) and `right` (runs, p): normal equations of every run.
    """

    excitation: tuple[str, ...]
    normal: Array
    right: Array

    def gained(self, groups: tuple[str | int, ...]) -> float:
        """Return the loss that the cause explains with coefficients of its own in every group of runs."""
        sums: dict[str | int, list[Array]] = defaultdict(lambda: [0.0, 0.0])  # type: ignore[list-item]
        for g, a, b in zip(groups, self.normal, self.right, strict=True):
            sums[g] = [sums[g][0] + a, sums[g][1] + b]
        return sum(float(b @ solve(a, b)) for a, b in sums.values())

    @cached_property
    def explained(self) -> float:
        """Loss that the cause explains with the same coefficients in all runs."""
        return self.gained((0,) * len(self.excitation))

    @cached_property
    def varying(self) -> float:
        """Loss that it explains in addition when each excitation has coefficients of its own."""
        return self.gained(self.excitation) - self.explained

    @property
    def spread(self) -> float:
        """Relative gain from fitting each excitation separately."""
        return self.varying / max(self.explained, 1.0)

    @property
    def constant(self) -> bool:
        """Whether one set of coefficients does."""
        return self.spread < CONSTANT or self.varying < CERTAIN

    @property
    def comparable(self) -> bool:
        """Whether there are coefficients that could differ, and more than one excitation in which they could."""
        return self.right.shape[1] > 0 and len(set(self.excitation)) > 1


def constancy_of(evidence: Evidence, fit: Fit, index: int) -> Constancy:
    """Return what every run determines of one cause of a fit."""
    data, term = evidence.data, fit.terms[index]
    normal = np.zeros((len(data.target), term.width, term.width))
    right = np.zeros((len(data.target), term.width))
    for r in range(len(data.target)):
        for channel in term.columns[r]:
            left = data.target[r][channel].copy()
            for j, other in enumerate(fit.terms):
                left -= other.fixed[r].get(channel, 0.0) if j == index else other.adds(r, channel, fit.of(j))
            wide = term.wide(r, channel, len(left))
            normal[r] += wide.T @ wide
            right[r] += wide.T @ left
    return Constancy(tuple(evidence.excitations), normal, right)
