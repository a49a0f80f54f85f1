"""Errors of the kinematics, each with its numbers."""

from __future__ import annotations

from sher3_common.errors import Sher3Error


class Unreachable(Sher3Error):
    """A pose or platform position that the mechanism cannot take.

    Attributes:
        part: The part whose end is exceeded, as in `delta_2`, `roll` or `tilt`.
        distance: How far the request lies beyond that end, in `unit`.
        unit: `m` or `rad`.
    """

    def __init__(self, what: str, *, part: str, distance: float, unit: str, value: object, limit: object) -> None:
        remedy = f"move the request by at least {distance:.6g} {unit} into the workspace"
        super().__init__(f"{what} ({part})", value=value, limit=limit, remedy=remedy)
        self.part = part
        self.distance = distance
        self.unit = unit


class OutsideLimits(Sher3Error):
    """An actuator position beyond its travel.

    Attributes:
        actuator: name of the actuator.
        distance: how far beyond its limit [m or rad].
    """

    def __init__(self, actuator: str, *, value: float, lower: float, upper: float, unit: str) -> None:
        limit = f"{lower:.6g} to {upper:.6g}"
        super().__init__(f"{actuator} is beyond its travel [{unit}]", value=value, limit=limit, remedy="stay within it")
        self.actuator = actuator
        self.distance = max(lower - value, value - upper)


class Singular(Sher3Error):
    """A configuration in which a velocity or force cannot be transmitted.

    Attributes:
        part: the singular part, as in `delta_2`, `delta` or `tilt`.
        distance: dimensionless distance to the singularity, 0 at it.
    """

    def __init__(self, part: str, *, distance: float, limit: float) -> None:
        super().__init__(
            f"{part} is at a singularity (dimensionless distance)",
            value=distance,
            limit=f">= {limit:.6g}",
            remedy="move back into the workspace",
        )
        self.part = part
        self.distance = distance


class BadInput(Sher3Error):
    """A vector or matrix of the wrong shape, not finite, or without direction."""
