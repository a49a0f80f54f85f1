"""Friction of an axis in the plant: one bristle, whose sliding level the effects raise.

F = g(v, q, t) z / displacement with z' = v - |v| z / displacement: elastic before it slides, g in sliding, no damping
(Dahl 1968; LuGre, Canudas de Wit 1995). Levels add up; of several deflections the largest counts.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from sher3_sim.effect import parameter
from sher3_sim.parameters import PlantParameters

SHORT = 2e-6
"""Deflection at which friction slides where nobody states one, m: about a count of the motor encoders."""


def deflection(default: float = SHORT) -> Any:
    """Declare the deflection before sliding as a parameter."""
    return parameter("m", default, 1e-8, 1e-3, "deflection before sliding")


def soften(p: PlantParameters, rows: list[int], displacement: float) -> None:
    """Let the bristle of some axes bend by at least `displacement` (m or rad) before it slides."""
    p.axis["displacement"][rows] = np.maximum(p.axis["displacement"][rows], displacement)


def rub(p: PlantParameters, rows: list[int], force: float, displacement: float) -> None:
    """Raise the friction of some axes by `force` (N or N m), in sliding and at rest, and soften their bristles."""
    p.axis["coulomb"][rows] += force
    p.axis["static"][rows] += force
    soften(p, rows, displacement)
