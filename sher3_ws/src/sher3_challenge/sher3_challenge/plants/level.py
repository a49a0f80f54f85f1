"""How imperfect one robot is: its deviations as built, and the share by which its laws differ from their pages.

Both are drawn per robot over a decade. Weights that are set on robots all built equally well call the next one foreign.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_description import ACTUATORS

from sher3_challenge.plants.site import ANGULAR

Array = NDArray[np.floating[Any]]

BUILT = (0.3, 3.0)
"""Range of the factor on deviations as built; none goes beyond its tolerance, three standard deviations."""
SHAPE = (0.003, 0.10)
"""Range of the share of an effect's power by which its law is another than its page's: what its closure may lack."""
PERIOD = (0.8e-3, 8e-3)
"""Travel of a slider over which a law bends once [m]: between a lead and its whole stroke."""
QUICK = 0.1
"""Largest travel that bends a law as much as a speed does, over that speed [s]: a millimetre at 10 mm/s."""


class Bend(NamedTuple):
    """Factors 1 + size sin(rate q + quick v + phase) of five axes, in their units; (5,) each."""

    size: Array
    rate: Array
    quick: Array
    phase: Array

    def factor(self, q: Array) -> Array:
        """Return (..., 5) the factors at positions (..., 5)."""
        return np.asarray(1 + self.size * np.sin(self.rate * q + self.phase))


@dataclass(frozen=True)
class Level:
    """How imperfect one robot is.

    Attributes:
        built: factor on its deviations as built.
        shape: share of an effect's power by which its law is bent.
    """

    built: float = 1.0
    shape: float = 0.0

    @classmethod
    def drawn(cls, seed: int) -> Level:
        """Return the level of the robot of a seed, log-uniform over `BUILT` and `SHAPE`."""
        rng = np.random.default_rng((27, seed))
        built, shape = (float(np.exp(rng.uniform(*np.log(ends)))) for ends in (BUILT, SHAPE))
        return cls(built, shape)

    def off(self, rng: np.random.Generator, sigma: Any, shape: Any = ()) -> Any:
        """Return deviations of a standard deviation `sigma` times the level, none beyond three of `sigma`."""
        return sigma * np.clip(self.built * rng.standard_normal(shape), -3.0, 3.0)

    def bend(self, seed: int) -> Bend:
        """Return how the laws of the five axes are bent."""
        rng = np.random.default_rng((28, seed))
        unit = np.array([ANGULAR["length"] if name == "roll" else 1.0 for name in ACTUATORS])
        rate = 2 * math.pi / (unit * np.exp(rng.uniform(math.log(PERIOD[0]), math.log(PERIOD[1]), len(unit))))
        quick = QUICK * rate * rng.uniform(-1.0, 1.0, len(unit))
        size = np.full(len(unit), math.sqrt(2.0 * self.shape))
        return Bend(size, rate, quick, rng.uniform(0.0, 2 * math.pi, len(unit)))

    def bent(self, seed: int, nominal: Array, true: Array, inputs: Array) -> Array:
        """Return what a stage behind the axes does, (n, d): its difference from the nominal, bent by component.

        Args:
            seed: of the robot.
            nominal: (n, d) what the stage does by its drawing.
            true: (n, d) what it does with its effects.
            inputs: (n, k) what its laws depend on, each about one in size.
        """
        if not self.shape:
            return true
        rng = np.random.default_rng((29, seed, nominal.shape[1]))
        rates = rng.standard_normal((inputs.shape[1], nominal.shape[1])) * math.pi / math.sqrt(inputs.shape[1])
        phase = rng.uniform(0.0, 2 * math.pi, nominal.shape[1])
        factor = 1 + math.sqrt(2.0 * self.shape) * np.sin(inputs @ rates + phase)
        return np.asarray(nominal + (true - nominal) * factor)


EXACT = Level(0.0, 0.0)
"""A robot exactly as its file says."""
