"""What is physically possible holds for the ends of an interval too: no friction builds up over less than nothing."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_diagnosis.channel import Array
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.fit.term import Term
from sher3_diagnosis.judge.meaning import linear_in
from sher3_diagnosis.verdict import Cause, Parameter

NEVER_BELOW_ZERO = frozenset(
    {
        *("displacement", "static", "stribeck_velocity", "width", "stiffness", "compliance", "time_constant"),
        *("stiffness_beyond", "late"),
        *("frequency", "inertia", "mass", "load_mass", "load_friction", "limit"),
    }
)
"""Parameters that have no sign, unless the bounds of a page say otherwise."""
FRICTION = "friction"
"""Family whose forces resist."""


def within_bounds(
    causes: Sequence[Cause], terms: Sequence[tuple[Term, Array]], effects: Sequence[Effect]
) -> list[Cause]:
    """Return the causes with intervals that end at what is physically possible; values are the fit's and stay.

    What the fit is linear in is cut there: it may be nothing. A value that was searched or is a reciprocal is known by
    a factor; where its interval would go below zero, that factor is the same downwards as upwards.

    Args:
        causes: as quantified.
        terms: each cause's term of the fit, with its coefficients (p,).
        effects: whose pages state bounds of their own.
    """
    stated = {e.id: e.bounds for e in effects}
    out = []
    for cause, (term, coefficients) in zip(causes, terms, strict=True):
        linear = linear_in(term, coefficients)
        cut = {n: _cut(cause, n, p, stated, n in linear) for n, p in cause.parameters.items()}
        out.append(cause.model_copy(update={"parameters": cut}))
    return out


def least_of(effect: Effect, name: str) -> float | None:
    """Return the smallest value of a parameter that is physically possible; None where it may have any sign."""
    return effect.bounds[name][0] if name in effect.bounds else _least(effect.family, name)


def _least(family: str, name: str) -> float | None:
    resists = family == FRICTION and name in ("force", "share")
    return 0.0 if name in NEVER_BELOW_ZERO or resists else None


def _cut(cause: Cause, name: str, p: Parameter, stated: dict, linear: bool) -> Parameter:
    """Return a parameter with its interval within bounds; that of a change between conditions may have any sign."""
    low, high = stated.get(cause.effect, {}).get(name, (_least(cause.family, name), None))
    if cause.condition is not None or p.low is None or p.high is None:
        return p
    least = p.low if low is None or p.low > low else (low if linear or low != 0.0 else p.value**2 / p.high)
    most = p.high if high is None else min(p.high, high)
    return p.model_copy(update={"low": least, "high": most}) if p.high > 0.0 and least <= p.value <= most else p
