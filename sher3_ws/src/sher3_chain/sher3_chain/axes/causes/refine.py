"""Constants of a free axis refined on its simulated motion.

Nothing holds a free axis to a reference: its motion carries the constants better than twice differentiated counts do.
Under a position loop it is the other way round, and nothing is refined.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import minimize
from sher3_diagnosis.channel import Array
from sher3_diagnosis.verdict import Cause, Parameter

from sher3_chain.axes.evidence import AxisEvidence
from sher3_chain.axes.simulate import law_of, simulate, simulated

REFINED = ("force", "static", "extra", "relative")
"""Parameters that are refined."""
FIRST_STEP = 0.1
"""First step of the search in the logarithm of each number: about 10 %."""
EVALUATIONS, TOLERANCE = 400, 1e-4
"""Largest number of simulations, and the relative change of the numbers at which the search ends."""

Name = tuple[int, str]
"""Index of a cause and name of its parameter."""


def refine_free(evidence: AxisEvidence, causes: list[Cause]) -> tuple[AxisEvidence, list[Cause]]:
    """Refine the forces of a free axis, and its mass where that is unknown, from the force balance's values.

    Returns:
        Evidence with the refined mass, and the refined causes; both unchanged where nothing can be improved.
    """
    names = [(i, n) for i, c in enumerate(causes) if c.effect in simulated() for n in c.parameters if n in REFINED]
    if not evidence.axis.free or evidence.mass <= 0.0 or not names:
        return evidence, causes
    with_mass = evidence.axis.mass == "unknown"

    def changed(x: Array) -> tuple[float, list[Cause]]:
        """Mass and causes with every number multiplied by the exponential of its entry in x."""
        factors = dict(zip(names, np.exp(x[: len(names)]), strict=True))
        mass = evidence.mass * (float(np.exp(x[-1])) if with_mass else 1.0)
        return mass, [_of(causes, index, factors) for index in range(len(causes))]

    def loss(x: Array) -> float:
        return loss_of_motion(evidence, *changed(x))

    start = np.zeros(len(names) + with_mass)
    simplex = np.vstack([start, start + FIRST_STEP * np.eye(len(start))])
    options = {"initial_simplex": simplex, "maxfev": EVALUATIONS, "xatol": TOLERANCE}
    best = minimize(loss, start, method="Nelder-Mead", options=options)
    if best.fun >= loss(start):
        return evidence, causes
    mass, refined = changed(best.x)
    agrees = all(_holds(causes[i].parameters[n], refined[i].parameters[n].value) for i, n in names)
    if with_mass and evidence.mass_interval is not None:
        agrees &= evidence.mass_interval[0] <= mass <= evidence.mass_interval[1]
    return (replace(evidence, mass=mass), refined) if agrees else (evidence, causes)


def _holds(parameter: Parameter, value: float) -> bool:
    """Return whether a value lies in the interval of a parameter.

    A motion that begins where it is unstable may be run again with any friction: it then fits other numbers as well.
    """
    low, high = parameter.low, parameter.high
    return (low is None or value >= low) and (high is None or value <= high)


def loss_of_motion(evidence: AxisEvidence, mass: float, causes: Sequence[Cause]) -> float:
    """Mean square error of the simulated positions, summed over the records."""
    axis, law, total = evidence.axis, law_of(causes), 0.0
    for run, view in zip(evidence.runs, evidence.records, strict=True):
        measured = run.signals[axis.name]["position"][view.release :]
        total += float(np.mean((simulate(run, axis, mass, law, view.release) - measured) ** 2))
    return total


def _of(causes: Sequence[Cause], index: int, factors: Mapping[Name, float]) -> Cause:
    return scaled(causes[index], {name: f for (i, name), f in factors.items() if i == index})


def scaled(cause: Cause, factors: Mapping[str, float]) -> Cause:
    """Return a cause with parameters times factors; their intervals move along and widen by the change."""
    new = dict(cause.parameters)
    for name, factor in factors.items():
        old = new[name]
        value, change = factor * old.value, abs((factor - 1.0) * old.value)
        low, high = old.low, old.high
        if low is not None and high is not None:
            half = 0.5 * (high - low) + change
            low, high = value - half, value + half
        new[name] = old.model_copy(update={"value": value, "low": low, "high": high})
    return cause.model_copy(update={"parameters": new})
