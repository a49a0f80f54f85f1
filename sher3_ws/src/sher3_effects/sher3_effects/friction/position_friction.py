"""Position-dependent friction: Coulomb friction that varies along the stroke."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_description import ACTUATORS, Robot
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.friction.bristle import deflection, rub
from sher3_effects.friction.dry import DryFriction
from sher3_effects.page import Part, Values
from sher3_effects.view import AxisView


class PositionFriction(DryFriction):
    """F = z (force + a cos kx + b sin kx + second harmonic): odd in the direction of motion, periodic along the stroke.

    Crests and hollows are seldom alike: the second harmonic lets crests be narrower than hollows, or wider. Friction
    nowhere pushes: mean and harmonics are those of some function that is nowhere negative (Caratheodory, Toeplitz: the
    matrix of its Fourier coefficients has no eigenvalue below zero), though two harmonics alone may dip below zero.
    """

    id, family, stage = "position_friction", "friction", "motor_mechanics"
    inputs = ("direction", "position")
    kinds = ("robot", "axis")
    needs = ("lead",)
    settles = True
    best = Best("reversals", "reversals of several amplitudes and speeds separate friction laws")
    extends = ("coulomb_friction",)
    extends_by = ("amplitude",)
    leaves_out = "the shape of its peaks, and that no two are alike"
    explanation = (
        "Friction changes along the stroke (seal, guide, ball return): at the same place the extra force has "
        "the opposite sign in the other direction."
    )
    siblings = {"cogging": "at the same place the force has the same sign in both directions"}
    units = {"wavelength": "m"}
    WAVELENGTHS = tuple(np.geomspace(0.2, 8.0, 28))
    """In motor revolutions."""
    SLACK = 0.1
    """Share of the mean by which that eigenvalue may be below zero: a fit to part of a stroke is off by as much."""
    finer = {"wavelength": (0.91, 0.94, 0.96, 0.98, 0.99, 1.01, 1.02, 1.04, 1.06, 1.1), "displacement": (0.4,)}

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Wavelength along the stroke."""
        scale = views[0].lead(site)
        return [{"wavelength": float(n) * scale, "displacement": 2.5e-3 * scale} for n in self.WAVELENGTHS]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Five columns: the mean force, its two quadratures, and those of the second harmonic."""
        axis = view.row(site)
        z = view.sliding(axis, shape["displacement"])
        phase = 2.0 * np.pi * view.run.smooth[:, axis] / shape["wavelength"]
        waves = (1.0, *(wave(n * phase) for n in (1, 2) for wave in (np.cos, np.sin)))
        parts = [view.run.to_grid(z * x) for x in waves]
        return Signature({Channel(self.stage, site): column(*parts)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return mean and amplitude of the variation, of the first three of (5,), and its wavelength."""
        return {
            "force": float(coefficients[0]),
            "amplitude": float(np.hypot(coefficients[1], coefficients[2])),
            "wavelength": shape["wavelength"],
        }

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the variation of (5,) exceeds a fifth of the mean, and friction can be positive everywhere."""
        marked = np.hypot(coefficients[1], coefficients[2]) > 0.2 * abs(coefficients[0])
        return bool(coefficients[0] > 0.0 and marked and least_of(coefficients) >= -self.SLACK * coefficients[0])

    def to_simulator(self, actuator: str, values: Values, robot: Robot) -> list[Part]:
        """Return the wavelength as periods per motor revolution."""
        lead = robot.actuators[ACTUATORS.index(actuator)].lead
        return [Part(self.id, actuator, {**values, "periods_per_rev": lead / values["wavelength"]})]


def least_of(coefficients: Array) -> float:
    """Return the least eigenvalue of the Toeplitz matrix of a mean and two harmonics a cos + b sin, (5,).

    It is not below zero if, and only if, some function that is nowhere negative has them.
    """
    first, second = (0.5 * complex(coefficients[k], -coefficients[k + 1]) for k in (1, 3))
    mean = complex(coefficients[0])
    rows = [
        [mean, first, second],
        [first.conjugate(), mean, first],
        [second.conjugate(), first.conjugate(), mean],
    ]
    return float(np.linalg.eigvalsh(np.array(rows))[0])


@dataclass(frozen=True)
class PositionFrictionInPlant(PlantEffect, page=PositionFriction):
    """Friction that changes along the travel, against motion in both directions: preload, guide, seal."""

    force: float = parameter("N", 1.0, 0.0, 50.0, "mean friction in sliding")
    amplitude: float = parameter("N", 0.5, 0.0, 50.0, "of its change along the travel")
    periods_per_rev: float = parameter("1", 1.0, 0.01, 200.0, "periods per lead")
    phase: float = parameter("rad", 0.0, -7.0, 7.0, "of the change at zero position", fixed_unit=True)
    displacement: float = deflection()

    def apply(self, p: PlantParameters) -> None:
        """Raise the level and modulate it."""
        p.axis["friction_amplitude"][self.rows] = self.amplitude
        p.axis["friction_periods"][self.rows] = self.periods_per_rev
        p.axis["friction_phase"][self.rows] = self.phase
        rub(p, self.rows, self.force, self.displacement)
