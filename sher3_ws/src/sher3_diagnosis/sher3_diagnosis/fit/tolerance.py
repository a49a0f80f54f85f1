"""What a healthy machine may deviate by from its drawing: terms that every fit carries and that stay within tolerance.

Each tolerance is a direction of the residuals, that of the effect it would be if it were larger, with a normal prior
of a third of the tolerance. Many of them look alike, so a group that shows on the same channels is turned into its
principal directions, of which those the data can see are kept: independent, each with a standard deviation of one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Effect, Shape, Signature
from sher3_diagnosis.fit.fitting import Fit, connected
from sher3_diagnosis.fit.gram import products
from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.fit.term import Term, make_term
from sher3_diagnosis.thresholds import VISIBLE, WITHIN
from sher3_diagnosis.verdict import Within

SIGMAS = 3.0
"""Standard deviations in a tolerance: values are three of them, or hard limits."""
NUISANCE = "nuisance"
"""Family of terms that are no causes."""


@dataclass(frozen=True)
class Tolerance:
    """One deviation: the term it would be as a cause, and for each of its coefficients a name, a limit and a unit."""

    term: Term
    limits: dict[str, tuple[float, str]]

    @property
    def sigma(self) -> Array:
        """Standard deviation of each coefficient, (p,)."""
        return np.array([limit / SIGMAS for limit, _ in self.limits.values()])

    def with_runs(self, more: Tolerance) -> Tolerance:
        """Return the deviation on its runs and on those of another evaluation."""
        return Tolerance(self.term.with_runs(more.term), self.limits)


class AsBuilt(Effect):
    """Deviations of a healthy machine that show on the same channels, in their principal directions."""

    id, family = "as_built", NUISANCE

    def __init__(self, members: Sequence[Tolerance], basis: Array) -> None:
        """Take the deviations and the (p, k) principal directions in units of their standard deviations."""
        self.members, self.basis = members, basis
        self.stage = members[0].term.effect.stage  # type: ignore[misc]

    @property
    def sigma(self) -> Array:
        """Standard deviation of every coefficient, (p,)."""
        return np.concatenate([m.sigma for m in self.members])

    def signature(self, view: Any, site: str, shape: Shape) -> Signature:
        """Return the principal directions in one run."""
        columns: dict[Channel, list[Array]] = {}
        start = 0
        for member in self.members:
            term = member.term
            part = self.basis[start : start + term.width] * member.sigma[:, None]
            for channel, x in term.effect.signature(view, term.site, term.shape).columns.items():
                columns.setdefault(channel, []).append(x @ part)
            start += term.width
        return Signature({channel: np.sum(parts, axis=0) for channel, parts in columns.items()})


def tolerance(
    data: Standardised, effect: Effect, site: str, shape: Shape, limits: dict[str, tuple[float, str]]
) -> Tolerance:
    """Evaluate one deviation on every run."""
    return Tolerance(make_term(data, effect, site, shape), limits)


def as_built(data: Standardised, members: Sequence[Tolerance]) -> tuple[Term, ...]:
    """Return one term for each group of deviations that share channels, in principal directions that the data see."""
    shown = [m for m in members if m.term.width == len(m.limits)]
    groups = connected([m.term for m in shown])
    found = (_principal(data, [shown[i] for i in group]) for group in groups)
    return tuple(t for t in found if t is not None)


def _principal(data: Standardised, members: list[Tolerance]) -> Term | None:
    terms = [m.term for m in members]
    channels = sorted({c for t in terms for c in t.channels})
    normal = np.sum([products(data, terms, c)[0].sum(axis=0) for c in channels], axis=0)
    sigma = np.concatenate([m.sigma for m in members])
    power, directions = np.linalg.eigh(normal * np.outer(sigma, sigma))
    basis = directions[:, power > VISIBLE]
    if basis.shape[1] == 0:
        return None
    columns: list[dict[Channel, Array]] = []
    for r in range(len(data.target)):
        run: dict[Channel, Array] = {}
        for channel in data.target[r].keys() & set(channels):
            start, total = 0, np.zeros((data.samples[r, channel], basis.shape[1]))
            for m in members:
                x = m.term.columns[r].get(channel)
                if x is not None:
                    total += x @ (basis[start : start + m.term.width] * m.sigma[:, None])
                start += m.term.width
            run[channel] = total
        columns.append(run)
    effect = AsBuilt(members, basis)
    site = "as_built:" + members[0].term.site
    return Term(effect, site, {}, columns, [{} for _ in columns], basis.shape[1], limit=SIGMAS)


def within(data: Standardised, found: Fit) -> list[Within]:
    """Return the deviations that a fit measured: those that differ from zero by more than their uncertainty."""
    out: list[Within] = []
    for i, term in enumerate(found.terms):
        if not isinstance(term.effect, AsBuilt):
            continue
        effect, basis, sigma = term.effect, term.effect.basis, term.effect.sigma
        normal = np.sum([products(data, [term], c)[0].sum(axis=0) for c in term.channels], axis=0)
        posterior = basis @ np.linalg.inv(normal + np.eye(term.width)) @ basis.T
        unseen = np.eye(len(sigma)) - basis @ basis.T
        error = sigma * np.sqrt(np.diagonal(posterior + unseen))
        names = [(n, limit, unit) for m in effect.members for n, (limit, unit) in m.limits.items()]
        for (name, limit, unit), value, doubt in zip(names, sigma * (basis @ found.of(i)), error, strict=True):
            if abs(value) > WITHIN * doubt:
                inside = float(np.clip(value, -limit, limit))
                out.append(Within(quantity=name, value=inside, tolerance=limit, unit=unit))
    return sorted(out, key=lambda w: -abs(w.value) / w.tolerance)
