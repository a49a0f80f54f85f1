"""What the search sees: residuals of a place over their floor, and any feature along the same samples."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.discover.feature import Factor, Feature, Quantities
from sher3_diagnosis.evidence import Evidence


@runtime_checkable
class Recorded(Protocol):
    """What discovery asks of a view of a run."""

    step: float
    """Time between two samples of the record, s."""

    def recorded(self, channel: Channel) -> Quantities:
        """Return whatever was recorded that the law of a gap in a channel might depend on."""

    def at_residuals(self, x: Array) -> Array:
        """Take (n, ...) values of the record to the grid of the residuals, (g, ...)."""


@dataclass(frozen=True)
class Columns:
    """Targets and features of the channels of one place.

    Attributes:
        evidence: of the part the place belongs to.
        channels: that show the place: one of an axis, two of a tip.
        views: per run.
        quantities: per run.
        target: per run, (N, d) residuals over their floor, the channels one behind the other.
    """

    evidence: Evidence
    channels: Sequence[Channel]
    views: Sequence[Recorded]
    quantities: Sequence[Quantities]
    target: Sequence[Array]
    _known: dict[tuple[int, Factor], Array] = field(default_factory=dict)

    @property
    def width(self) -> int:
        """Number of components d."""
        return self.target[0].shape[1]

    @property
    def units(self) -> Mapping[str, str]:
        """Quantity -> unit."""
        return {name: q.unit for name, q in self.quantities[0].items()}

    def floor(self, run: int, component: int) -> Array:
        """Return the floor of every sample of a run, (N,): channels of one place may have different floors."""
        counts = [int(self.evidence.data.residuals[run][c].ok.sum()) for c in self._of(run)]
        floors = [self.evidence.floors[run][c][component] for c in self._of(run)]
        return np.repeat(floors, counts)

    def _of(self, run: int) -> list[Channel]:
        return [c for c in self.channels if c in self.evidence.data.target[run]]

    def feature(self, run: int, feature: Feature) -> Array:
        """Return a feature on the residual grid of a run, (g,)."""
        out = np.ones(self._grid(run))
        self._learn(run, feature.factors)
        for factor in feature.factors:
            out = out * self._known[run, factor]
        return out

    def _learn(self, run: int, factors: Iterable[Factor]) -> None:
        """Evaluate factors that are not known yet, all in one pass of the low-pass."""
        view, new = self.views[run], [f for f in factors if (run, f) not in self._known]
        if new:
            along = np.column_stack([f.along(self.quantities[run], view.step) for f in new])
            found = view.at_residuals(along).T
            self._known.update({(run, f): x for f, x in zip(new, found, strict=True)})

    def _grid(self, run: int) -> int:
        return len(self.evidence.data.residuals[run][self._of(run)[0]].values)

    def at_samples(self, run: int, feature: Feature) -> Array:
        """Return a feature at the samples of the target, means included, (N,)."""
        values = self.feature(run, feature)
        return np.concatenate([values[self.evidence.data.residuals[run][c].ok] for c in self._of(run)])

    def design(self, run: int, features: Sequence[Feature]) -> Array:
        """Return features at the samples of the target, relieved of what a run's mean leaves free, (N, p)."""
        self._learn(run, list(dict.fromkeys(factor for f in features for factor in f.factors)))
        whole = np.column_stack([self.feature(run, f) for f in features])
        parts = [r.centred(whole[r.ok]) for c in self._of(run) for r in (self.evidence.data.residuals[run][c],)]
        return np.vstack(parts)


def columns(evidence: Evidence, channels: Sequence[Channel], target: Sequence[Mapping[Channel, Array]]) -> Columns:
    """Gather what the search needs of the runs that show a place.

    Args:
        evidence: of the part.
        channels: of one place, with the same components.
        target: per run and channel, (N,) standardised: the gap that is to be explained.
    """
    shown = [r for r, t in enumerate(target) if any(c in t for c in channels)]
    data = evidence.data
    reduced = type(data)(
        [data.views[r] for r in shown], [data.residuals[r] for r in shown], [data.floors[r] for r in shown]
    )
    part = Evidence([evidence.excitations[r] for r in shown], reduced, evidence.units, evidence.places)
    width = len(data.floors[shown[0]][next(c for c in channels if c in target[shown[0]])])
    views: list[Recorded] = part.views  # type: ignore[assignment]
    stacked = [np.vstack([target[r][c].reshape(-1, width) for c in channels if c in target[r]]) for r in shown]
    return Columns(part, channels, views, [v.recorded(channels[0]) for v in views], stacked)
