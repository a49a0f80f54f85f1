"""What is physically possible holds for the ends of an interval too: no friction builds up over less than nothing."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_diagnosis.effect import Effect
from sher3_diagnosis.verdict import Cause, Parameter

NEVER_BELOW_ZERO = frozenset(
    {
        *("displacement", "static", "stribeck_velocity", "width", "stiffness", "compliance", "time_constant"),
        *("frequency", "inertia", "mass", "load_mass", "load_friction", "limit"),
    }
)
"""Parameters of any effect that have no sign; a mass beside a stated one may be less, see `SIGNED`."""
SIGNED = frozenset({("payload_mass", "mass"), ("tool_gravity", "mass")})
"""What is added to a stated value, which its page bounds by that."""
FRICTION = "friction"
"""Family whose forces resist."""


def within_bounds(causes: Sequence[Cause], effects: Sequence[Effect]) -> list[Cause]:
    """Return the causes with intervals cut at what is physically possible; values are the fit's and stay.

    Args:
        causes: as quantified.
        effects: whose pages state bounds of their own.
    """
    stated = {e.id: e.bounds for e in effects}
    return [
        c.model_copy(update={"parameters": {n: _cut(c, n, p, stated) for n, p in c.parameters.items()}}) for c in causes
    ]


def least_of(effect: Effect, name: str) -> float | None:
    """Return the smallest value of a parameter that is physically possible; None where it may have any sign."""
    return effect.bounds[name][0] if name in effect.bounds else _least(effect.id, effect.family, name)


def _least(effect: str, family: str, name: str) -> float | None:
    resists = family == FRICTION and name in ("force", "share")
    return 0.0 if (name in NEVER_BELOW_ZERO and (effect, name) not in SIGNED) or resists else None


def _cut(cause: Cause, name: str, p: Parameter, stated: dict) -> Parameter:
    """Return a parameter with its interval cut; that of a change between conditions may have any sign."""
    low, high = stated.get(cause.effect, {}).get(name, (_least(cause.effect, cause.family, name), None))
    if cause.condition is not None or p.low is None or p.high is None:
        return p
    found = {"low": p.low if low is None else max(p.low, low), "high": p.high if high is None else min(p.high, high)}
    return p.model_copy(update=found) if found["low"] <= p.value <= found["high"] else p
