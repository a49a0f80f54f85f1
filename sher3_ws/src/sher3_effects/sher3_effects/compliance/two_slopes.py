"""A spring of two slopes: soft up to a knee, and stiffer (or softer) beyond, as the gear of a harmonic drive is."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.effect import Shape

KNEES = (0.3, 0.6, 1.0, 1.5, 2.0)
"""Forces at which the slope changes, over the rms one: below and above, half of the samples are too few to tell it."""
BENT_FROM = 0.004
"""Share of what two slopes explain that one must leave: what a further cause of an axis must be worth too."""
ON = (0.2, 0.8)
"""Shares of a knee between which a force is on the way to it."""
SEEN = 0.05
"""Share of the samples that must lie there."""
LEAST = 0.7
"""Share of the smallest knee that is tried below which none is searched."""
FINER = (0.75, 0.88, 0.95, 1.05, 1.14, 1.33)
"""Factors of a knee that a finer search tries."""


def knees(forces: Iterable[Array], shape: Shape) -> list[Shape]:
    """Return a shape with a knee in shares of the rms of some forces, each (g,); none where no force tells a knee.

    Loads that come in steps have no samples below the first step, where a soft spring cannot be told from a gap.
    """
    size = np.abs(np.concatenate(list(forces)))
    usual = float(np.sqrt(np.mean(size**2)))
    shown = [
        k * usual for k in KNEES if usual and np.mean((size > ON[0] * k * usual) & (size < ON[1] * k * usual)) > SEEN
    ]
    return [{**shape, "knee": knee, "least": min(shown)} for knee in shown]


def finer(shape: Shape) -> list[Shape]:
    """Return shapes whose knee is near that of a shape."""
    return [{**shape, "knee": shape["knee"] * factor} for factor in FINER]


def is_shown(shape: Shape) -> bool:
    """Return whether a shape has no knee, or a knee above the smallest force at which the records would show it."""
    return "knee" not in shape or shape["knee"] >= LEAST * shape["least"]


def parts(force: Array, shape: Shape) -> list[Array]:
    """Return the force (g,) in one part, or in two: up to the knee, and beyond it."""
    if "knee" not in shape:
        return [force]
    below = np.clip(force, -shape["knee"], shape["knee"])
    return [below, force - below]


def slopes(shape: Shape, coefficients: Array) -> dict[str, float]:
    """Return the knee and the stiffness beyond it, by the second of two compliances (2,); nothing of one slope."""
    if "knee" not in shape:
        return {}
    beyond = float(coefficients[1])
    return {"knee": shape["knee"], "stiffness_beyond": 1.0 / beyond if beyond else 0.0}
