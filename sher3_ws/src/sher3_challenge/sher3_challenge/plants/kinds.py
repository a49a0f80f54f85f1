"""Faults of a truth plant as data: a kind, a place, and the magnitude and the seed that fix it completely.

A plant registers its kinds in a `Catalogue` of its own. `apply` writes a fault into the plant's own `rig`, of which
nothing is known here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sher3_common import Sher3Error
from sher3_description import ACTUATORS

from sher3_challenge.plants.declared import DECLARED, Row

ANGULAR = {"length": 31.4, "force": 0.025, "stiffness": 8e-4, "compliance": 1256.0, "speed": 98.0, "inertia": 2e-3}
"""What one unit of a slider becomes on the roll axis, by ratio of encoder steps, rated forces and speed limits."""


class FaultError(Sher3Error):
    """An unknown fault, or one on an actuator where it cannot sit."""


@dataclass(frozen=True)
class Site:
    """Where a fault sits and how its kind scales there.

    Attributes:
        actuator: an actuator, or `tip`, `force_sensor`, `all`.
        rng: draws the fault's shape (phase, period, direction); the same every time the fault is applied.
    """

    actuator: str
    rng: np.random.Generator

    @property
    def index(self) -> int:
        """Index of the actuator; all others are errors."""
        return ACTUATORS.index(self.actuator)

    @property
    def rows(self) -> slice:
        """Rows of the per-actuator arrays that the fault changes."""
        return slice(None) if self.actuator == "all" else slice(self.index, self.index + 1)

    def scaled(self, value: float, dimension: str) -> float:
        """Return a slider's value in the actuator's unit."""
        return value * ANGULAR[dimension] if self.actuator == "roll" else value

    def sign(self) -> float:
        """Return +1 or -1."""
        return float(self.rng.choice([-1.0, 1.0]))

    def direction(self, dimensions: int = 3) -> NDArray[np.floating[Any]]:
        """Return a random unit vector."""
        v = self.rng.standard_normal(dimensions)
        return np.asarray(v / np.linalg.norm(v))


Apply = Callable[[Any, Site, float], dict[str, float]]


@dataclass(frozen=True, kw_only=True)
class Kind(Row):
    """One kind of fault of one truth plant.

    Attributes:
        name: effect id of the contract, or a name of its own outside the catalogue.
        apply: writes the fault of a magnitude into a rig; returns its parameters by the contract's names.
    """

    name: str
    apply: Apply

    @property
    def effect(self) -> str:
        """Effect id of the contract; `outside_library` for what has none."""
        if self.family == "outside":
            return "outside_library"
        return "cable_drag" if self.name.startswith("cable_drag") else self.name

    @property
    def exact(self) -> bool:
        """Whether the stage has no floor but rounding."""
        return self.stage in ("transport", "controller")


@dataclass(frozen=True)
class Fault:
    """A kind of fault at a place, with its magnitude (a slider's unit) and the seed of its shape."""

    kind: Kind
    actuator: str
    magnitude: float
    seed: int

    def apply(self, rig: Any) -> dict[str, float]:
        """Write the fault into a rig; return its parameters."""
        if self.actuator not in self.kind.places:
            limit = ", ".join(self.kind.places)
            raise FaultError(f"{self.kind.name} cannot sit there", value=self.actuator, limit=limit)
        return self.kind.apply(rig, Site(self.actuator, np.random.default_rng(self.seed)), self.magnitude)

    def scaled_by(self, factor: float) -> Fault:
        """Return the fault with its magnitude multiplied, kept between the least and the most of its kind."""
        magnitude = min(self.kind.most, max(self.kind.least, self.magnitude * factor))
        return Fault(self.kind, self.actuator, magnitude, self.seed)


class Catalogue(dict[str, Kind]):
    """Kinds of faults by name, filled by its decorators."""

    def known(self, apply: Apply) -> Apply:
        """Register the decorated function as the kind that is declared under its name."""
        return self._register(apply, DECLARED[apply.__name__])

    def add(
        self, family: str, stage: str, places: tuple[str, ...], start: float, least: float, most: float,
        also: tuple[str, ...] = (), company: tuple[str, ...] = (),
    ) -> Callable[[Apply], Apply]:  # fmt: skip
        """Register the decorated function as the kind of its name."""
        return partial(self._register, row=Row(family, stage, places, start, least, most, also, company))

    def _register(self, apply: Apply, row: Row) -> Apply:
        self[apply.__name__] = Kind(**vars(row), name=apply.__name__, apply=apply)
        return apply
