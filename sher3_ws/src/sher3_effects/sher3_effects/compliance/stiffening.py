"""Springs that stiffen: contacts close and beams stretch, so that a compliance falls as the force grows."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.effect import Shape

STATED_AT = 1.0
"""Force on the tip at which a compliance that changes with it is stated, N."""
HALVED = (2.0, 6.0, 20.0)
"""Forces tried first at which a compliance has fallen to half, N: tips are loaded by one or two."""
FINER = {"stiffens": (0.5, 0.7, 0.85, 1.2, 1.4, 2.0)}
"""Factors of the finer search for that force."""


def stiffened(shape: Shape) -> list[Shape]:
    """Return a shape of a spring with the forces at which its compliance may have fallen to half."""
    return [{**shape, "stiffens": force} for force in HALVED]


def softness(force: Array, shape: Shape) -> Array:
    """Return (g, 1, 1): compliance c / (1 + |F| / stiffens) under forces (g, 3) [N], over that at `STATED_AT`."""
    knee = shape.get("stiffens", np.inf)
    return ((1.0 + STATED_AT / knee) / (1.0 + np.linalg.norm(force, axis=1) / knee))[:, None, None]
