"""The sparse search: forward by held-out loss, with every shape refined as it enters, and backward at the end.

Losses are sums of squares over the floor of runs that the coefficients were not fitted to (leave one run out).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from sher3_common.laws import LAWS

from sher3_diagnosis.channel import Array
from sher3_diagnosis.discover.columns import Columns
from sher3_diagnosis.discover.dictionary import Group
from sher3_diagnosis.discover.feature import Factor, Feature
from sher3_diagnosis.fit.fitting import RIDGE
from sher3_diagnosis.thresholds import PLAIN, PRICE, TERM_WORTH, TERMS

REFINED = 40
"""Evaluations of the loss in the refinement of one group's shapes."""
WIDEST = 1.0
"""Logarithm by which a refined shape may leave its starting value at most."""
TRIED = 3
"""Best groups of a step whose shapes are refined before one is taken."""

Suggest = Callable[[list[Array]], list[Group]]
"""Groups suggested by what is left in every run."""


@dataclass(frozen=True)
class Moments:
    """Normal equations per run: `normal` (R, p, p), `right` (R, p), `energy` (R,)."""

    normal: Array
    right: Array
    energy: Array

    def losses(self, chosen: Sequence[int], added: NDArray[np.int64]) -> Array:
        """Held-out loss of `chosen` columns with each row of `added` (k, m) columns, (k,)."""
        index = np.hstack([np.tile(np.array(chosen, dtype=int), (len(added), 1)), added])
        a = self.normal[:, index[:, :, None], index[:, None, :]]
        b = self.right[:, index]
        total, all_right = a.sum(axis=0)[None] - a, b.sum(axis=0)[None] - b
        held = _solve(total, all_right)
        fitted = np.einsum("rki,rkij,rkj->rk", held, a, held) - 2.0 * np.einsum("rki,rki->rk", held, b)
        return np.sum(self.energy[:, None] + fitted, axis=0)

    def without(self, run: int) -> Moments:
        """Return the normal equations of the other runs."""
        kept = [r for r in range(len(self.energy)) if r != run]
        return Moments(self.normal[kept], self.right[kept], self.energy[kept])

    def coefficients(self, chosen: Sequence[int]) -> Array:
        """Least squares on all runs, (p,)."""
        i = np.array(chosen, dtype=int)
        return _solve(self.normal.sum(axis=0)[np.ix_(i, i)], self.right.sum(axis=0)[i])


def _solve(normal: Array, right: Array) -> Array:
    scale = np.sqrt(np.einsum("...ii->...i", normal))
    scale = np.where(scale > 0.0, scale, 1.0)
    a = normal / (scale[..., :, None] * scale[..., None, :]) + RIDGE * np.eye(normal.shape[-1])
    return np.linalg.solve(a, (right / scale)[..., None])[..., 0] / scale


@dataclass(frozen=True)
class Found:
    """A formula of one component: groups and the held-out loss without and with them."""

    groups: tuple[Group, ...]
    null: float
    loss: float

    @property
    def features(self) -> list[Feature]:
        """Features of all groups."""
        return [f for g in self.groups for f in g]


@dataclass(frozen=True)
class Search:
    """One component of a place on some of its runs.

    Attributes:
        columns: targets and features.
        component: which of the residual.
        runs: that are looked at.
        designs: per run of `columns`, (N, P) columns of the dictionary.
        groups: of the dictionary, and `index` their columns.
    """

    columns: Columns
    component: int
    runs: Sequence[int]
    designs: Sequence[Array]
    normals: Sequence[Array]
    groups: Sequence[Group]

    def target(self, run: int) -> Array:
        """Standardised target (N,)."""
        return self.columns.target[run][:, self.component]

    def moments(self, features: Sequence[Feature]) -> Moments:
        """Normal equations of some features."""
        normal, right, energy = [], [], []
        for r in self.runs:
            y = self.target(r)
            x = self.columns.design(r, features) / self.columns.floor(r, self.component)[:, None]
            normal.append(x.T @ x)
            right.append(x.T @ y)
            energy.append(y @ y)
        return Moments(np.array(normal), np.array(right), np.array(energy))

    def loss(self, groups: Sequence[Group]) -> float:
        """Held-out loss of a formula."""
        features = [f for g in groups for f in g]
        return float(self.moments(features).losses([], np.arange(len(features))[None])[0])

    def left(self, groups: Sequence[Group]) -> list[Array]:
        """What a formula leaves in every run, standardised, (N,) each."""
        features = [f for g in groups for f in g]
        if not features:
            return [self.target(r) for r in self.runs]
        beta = self.moments(features).coefficients(range(len(features)))
        out = []
        for r in self.runs:
            x = self.columns.design(r, features) / self.columns.floor(r, self.component)[:, None]
            out.append(self.target(r) - x @ beta)
        return out

    def run(self, suggest: Suggest) -> Found:
        """Add groups while each pays its price in held-out loss, then drop those that no longer do."""
        null = float(sum(np.sum(self.target(r) ** 2) for r in self.runs))
        excess = max(null - sum(len(self.target(r)) for r in self.runs), 1.0)
        groups: list[Group] = []
        loss = null
        while len(groups) < TERMS:
            step = self._step(groups, loss, excess, suggest(self.left(groups)))
            if step is None:
                break
            groups, loss = step
        groups, loss = self._prune(groups, loss, excess)
        return Found(tuple(groups), null, loss)

    def _price(self, group: Group, excess: float) -> float:
        numbers = sum(f.numbers for f in group)
        return PRICE * numbers + PLAIN * excess * numbers

    def _step(
        self, groups: list[Group], loss: float, excess: float, more: Sequence[Group]
    ) -> tuple[list[Group], float] | None:
        ranked = sorted([*self._from_dictionary(groups), *self._from(groups, more)], key=lambda x: x[0])
        best: tuple[float, Group] | None = None
        for _, group in self._priced(ranked, excess)[:TRIED]:
            tried = self._refined(groups, group)
            value = self.loss([*groups, tried]) + self._price(tried, excess)
            if best is None or value < best[0]:
                best = (value, tried)
        if best is None:
            return None
        now = best[0] - self._price(best[1], excess)
        if loss - best[0] < 0.0 or loss - now < TERM_WORTH * excess:
            return None
        return [*groups, best[1]], now

    def _priced(self, ranked: Sequence[tuple[float, Group]], excess: float) -> list[tuple[float, Group]]:
        return sorted(((v + self._price(g, excess), g) for v, g in ranked), key=lambda x: x[0])

    def _from_dictionary(self, groups: Sequence[Group]) -> list[tuple[float, Group]]:
        """Loss of the formula with each group of the dictionary added."""
        chosen = [f for g in groups for f in g]
        k, p = len(chosen), self.designs[0].shape[1]
        normal, right, energy = np.zeros((len(self.runs), k + p, k + p)), np.zeros((len(self.runs), k + p)), []
        for n, r in enumerate(self.runs):
            floor, y = self.columns.floor(r, self.component), self.target(r)
            one = 1.0 / floor**2
            x = self.designs[r]
            if np.ptp(floor) == 0.0:
                normal[n, k:, k:] = self.normals[r] * one[0]
            else:
                normal[n, k:, k:] = (x * one[:, None]).T @ x
            right[n, k:] = x.T @ (y / floor)
            energy.append(y @ y)
            if k:
                z = self.columns.design(r, chosen)
                normal[n, :k, :k] = (z * one[:, None]).T @ z
                normal[n, :k, k:] = (z * one[:, None]).T @ x
                normal[n, k:, :k] = normal[n, :k, k:].T
                right[n, :k] = z.T @ (y / floor)
        moments = Moments(normal, right, np.array(energy))
        taken = set(groups)
        index = np.arange(p)[:, None] + k
        losses = moments.losses(range(k), index)
        return [(float(v), g) for v, g in zip(losses, self.groups, strict=True) if g not in taken]

    def _from(self, groups: Sequence[Group], more: Sequence[Group]) -> list[tuple[float, Group]]:
        return [(self.loss([*groups, g]), g) for g in more]

    def _refined(self, groups: Sequence[Group], group: Group) -> Group:
        """Move the shapes of a group to where the loss is least, by a simplex over their logarithms."""
        shape = np.array(group[0].shape)
        if not len(shape):
            return group
        shifted = np.array([x for f in group[0].factors for x in _shifts(f)])

        def moved(step: Array) -> Group:
            values = np.where(shifted > 0.0, shape + shifted * step, shape * np.exp(np.clip(step, -WIDEST, WIDEST)))
            return tuple(f.reshaped(tuple(map(float, values))) for f in group)

        start = np.vstack([np.zeros(len(shape)), 0.3 * np.eye(len(shape))])
        found = minimize(
            lambda s: self.loss([*groups, moved(s)]),
            np.zeros(len(shape)),
            method="Nelder-Mead",
            options={"maxfev": REFINED, "initial_simplex": start, "xatol": 0.01, "fatol": 1.0},
        )
        return moved(found.x)

    def _prune(self, groups: list[Group], loss: float, excess: float) -> tuple[list[Group], float]:
        while len(groups) > 1:
            without = [self.loss([h for h in groups if h is not g]) for g in groups]
            i = int(np.argmin([v - self._price(g, excess) for v, g in zip(without, groups, strict=True)]))
            if without[i] - loss > max(self._price(groups[i], excess), TERM_WORTH * excess):
                break
            loss = without[i]
            groups = [g for j, g in enumerate(groups) if j != i]
        return groups, loss


def _shifts(factor: Factor) -> list[float]:
    """For each shape the unit of its steps, if it is a place and no scale: a centre moves by shares of its width."""
    names = LAWS[factor.law].shapes
    return [factor.shape[-1] if name == "centre" else 0.0 for name in names]
