"""What a record of one axis may not tell apart: stiction and a dead band, sag and a zero, a spring and a weight.

A servo whose force c v is stiffness times error less a friction F, and a valve whose flow v is K times the error less a
band b, obey one equation: v = (error less b) / T beyond the band, none within it, b = F over stiffness. Their readings
are the same at any speed. The force, the command against its law, or a run under another load tells them.

A servo that rests beside its reference by a constant hangs under a weight, or the place that it is told and the place
that is read have different zeros.

A spring and the sine of a weight at an arm are the same over a small travel, and each has numbers of its own: neither
contains the other, as both contain a constant force.

A servo of two poles, T and m / T (its mass over its stiffness is m), looks like one of a first order and a dead time
m / T. Counts hide accelerations, so that m comes out too small and the dead time too long.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, Term
from sher3_diagnosis.thresholds import NEEDED
from sher3_diagnosis.verdict import Cause, Parameter
from sher3_effects import pages

SIZES = ("force", "width")
"""Parameters of what is one constant in the error of a servo: a force over its stiffness, a gap."""
SECOND_POLE = 1.0 / 3.0
"""Share of a lag T that a second pole hidden in a dead time has at most: a servo of lag T + s and mass s (T + s) does
not ring where that mass is below a quarter of its lag's square, so that s is below T / 3."""


def parted_by_travel(evidence: Evidence, found: Attribution) -> Attribution:
    """Return the causes without the spring, or the weight at an arm, whichever leaves markedly more than the other.

    Both laws are exact, and over a travel of 2 rad they part by 0.4 % of the gap: what a further cause must be worth.
    """
    rivals, ranking = list(found.rivals), list(found.ranking)
    for i in found.causes:
        share = found.fit.terms[i].effect.parted_by_travel
        if share:
            most = found.fit.total + max(NEEDED, share * found.explained[i])
            rivals[i], ranking[i] = (_close(fits, found.fit.terms[i], most) for fits in (rivals[i], ranking[i]))
    return replace(found, rivals=tuple(rivals), ranking=tuple(ranking))


def _close(fits: Sequence[Fit], own: Term, most: float) -> tuple[Fit, ...]:
    """Return the fits without those of another law that the travel tells from a cause, by their loss."""
    others = ((f, f.terms[-1].effect) for f in fits)
    return tuple(f for f, e in others if not e.parted_by_travel or e.id == own.effect.id or f.total < most)


def indistinct(cause: Cause) -> list[tuple[str, str]]:
    """Return effects that give a servo the same readings as one constant does, each with what tells it apart."""
    constant = any(name in SIZES for name in cause.parameters)
    page = next((e for e in pages("servo") if e.id == cause.effect and constant), None)
    return [(other, page.siblings[other]) for other in page.indistinct] if page is not None else []


def with_indistinct(causes: Sequence[Cause]) -> list[Cause]:
    """Return the causes of a position servo with what gives it the same readings among their rivals."""
    beside = [[other for other, _ in indistinct(cause)] for cause in causes]
    return [
        cause.model_copy(update={"rivals": list(dict.fromkeys([*cause.rivals, *others]))})
        for cause, others in zip(causes, beside, strict=True)
    ]


def with_second_pole(causes: Sequence[Cause]) -> list[Cause]:
    """Return the causes of a position servo with what a second pole may take of a dead time beside its lag.

    The sum of dead time and lag is what the record tells: where one is shorter, the other is longer by as much.
    """
    return [_second_pole(c) if {"time_constant", "delay"} <= c.parameters.keys() else c for c in causes]


def _second_pole(cause: Cause) -> Cause:
    parameters = cause.parameters
    lag, delay = parameters["time_constant"], parameters["delay"]
    seen = parameters["inertia"].value / lag.value if "inertia" in parameters else 0.0
    hidden = max(SECOND_POLE * lag.value - seen, 0.0)
    wider = {"time_constant": _wider(lag, 0.0, hidden), "delay": _wider(delay, min(hidden, delay.value), 0.0)}
    return cause.model_copy(update={"parameters": {**parameters, **wider}})


def _wider(p: Parameter, below: float, above: float) -> Parameter:
    """Return a parameter whose interval also holds what lies below and above its value."""
    if p.low is None or p.high is None:
        return p
    low, high = float(np.hypot(p.value - p.low, below)), float(np.hypot(p.high - p.value, above))
    return p.model_copy(update={"low": p.value - low, "high": p.value + high})


def indistinct_notes(name: str, causes: Sequence[Cause], unit: str) -> list[str]:
    """Return what would tell causes of a position servo from what gives it the same readings."""
    return [
        f"{name}: {cause.effect.replace('_', ' ')} and {other.replace('_', ' ')} of {size.value:.3g} {unit} give a "
        "servo the same readings; the recorded force, the command with its stated law, and runs tagged with two loads "
        f"tell them apart: {told}"
        for cause in causes
        for other, told in indistinct(cause)
        for size in [next(p for n, p in cause.parameters.items() if n in SIZES)]
    ]
