"""The mechanism of the plant where it is not as drawn."""

from __future__ import annotations

import math
from typing import Any

from sher3_sim.effect import parameter
from sher3_sim.parameters import PlantParameters


def metres(default: float, text: str) -> Any:
    """Declare a length error of up to 5 mm, which stays a length on every axis."""
    return parameter("m", default, -5e-3, 5e-3, text, fixed_unit=True)


def radians(default: float, text: str, limit: float = 0.1) -> Any:
    """Declare an angle of up to `limit`, rad."""
    return parameter("rad", default, -limit, limit, text, fixed_unit=True)


def shift(p: PlantParameters, **changes: float) -> None:
    """Add to values of the true mechanism's geometry."""
    p.geometry = p.geometry._replace(**{name: getattr(p.geometry, name) + by for name, by in changes.items()})


def direction(p: PlantParameters, leg: int) -> tuple[float, float]:
    """Return cosine and sine of the azimuth of a leg, counted from 0."""
    azimuth = p.robot.delta.leg_azimuth[leg]
    return math.cos(azimuth), math.sin(azimuth)
