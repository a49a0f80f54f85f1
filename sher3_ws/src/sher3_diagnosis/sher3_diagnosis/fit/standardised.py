"""Residuals over their floor: a channel at its floor then has a mean square of one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any

from sher3_diagnosis.channel import Array, Channel, Floors, Residuals


class Standardised:
    """Residuals of all runs over their floor, ready for least squares.

    Attributes:
        views: per run, what effects see of it.
        residuals, floors: per run and channel.
        target: `target[r][c]` is the (N,) vector of channel c in run r: samples that count, components in turn.
        fits: kept by `sher3_diagnosis.fit.fitting`.
        rows: per channel the target of all runs behind each other; by `fit.gram`.
        trails: per channel the terms of the last fit, each with the products so far; by `fit.gram`.
    """

    def __init__(
        self,
        views: Sequence[Any],
        residuals: Sequence[Residuals],
        floors: Sequence[Floors],
        target: Sequence[dict[Channel, Array]] | None = None,
    ) -> None:
        """Take runs; `target` is what is looked at in place of their residuals."""
        self.views = list(views)
        self.residuals = list(residuals)
        self.floors = list(floors)
        self.fits: dict[tuple[int, ...], Any] = {}
        self.rows: dict[Channel, Any] = {}
        self.trails: dict[Channel, list[Any]] = {}
        self.target = list(target or self._targets())

    def _targets(self) -> Iterator[dict[Channel, Array]]:
        for r, residuals in enumerate(self.residuals):
            yield {c: self.flat(r, c, x.values) for c, x in residuals.items() if x.ok.any()}

    def with_runs(self, more: Standardised, target: Sequence[dict[Channel, Array]]) -> Standardised:
        """Return these runs and others, of which something else than their residuals is looked at, (N,) over floors."""
        floors = [*self.floors, *more.floors]
        return Standardised(
            [*self.views, *more.views], [*self.residuals, *more.residuals], floors, [*self.target, *target]
        )

    def flat(self, run: int, channel: Channel, values: Array) -> Array:
        """Whiten (g, d) or (g, d, p) values of a channel and flatten the samples that count -> (N,) or (N, p)."""
        residual = self.residuals[run][channel]
        kept = residual.relieved(values.take(residual.counting, axis=0))
        scale = self.floors[run][channel]
        kept = kept / (scale[:, None] if kept.ndim == 3 else scale)
        return kept.reshape(-1, kept.shape[2]) if kept.ndim == 3 else kept.ravel()

    @cached_property
    def null_loss(self) -> dict[tuple[int, Channel], float]:
        """Sum of squares of every run and channel without any effect."""
        return {(r, c): float(y @ y) for r, t in enumerate(self.target) for c, y in t.items()}

    @cached_property
    def samples(self) -> dict[tuple[int, Channel], int]:
        """Number of standardised samples of every run and channel."""
        return {(r, c): len(y) for r, t in enumerate(self.target) for c, y in t.items()}
