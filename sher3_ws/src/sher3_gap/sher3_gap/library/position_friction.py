"""Position-dependent friction: Coulomb friction that varies along the stroke."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of, column, lead


class PositionFriction(LibraryEffect):
    """F = z (force + a cos kx + b sin kx): odd in the direction of motion, periodic along the stroke."""

    id, family, stage = "position_friction", "friction", "motor_mechanics"
    extends = ("coulomb_friction",)
    explanation = (
        "Friction changes along the stroke (seal, guide, ball return): at the same place the extra force has "
        "the opposite sign in the other direction."
    )
    siblings = {"cogging": "at the same place the force has the same sign in both directions"}
    units = {"force": "N", "amplitude": "N", "wavelength": "m"}
    WAVELENGTHS = tuple(np.geomspace(0.2, 8.0, 28))
    """In motor revolutions."""

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Wavelength along the stroke."""
        scale = lead(views[0], site)
        return [{"wavelength": float(n) * scale, "displacement": 2.5e-3 * scale} for n in self.WAVELENGTHS]

    def refine(self, shape: Shape) -> list[Shape]:
        """Wavelengths between the neighbours, and a shorter displacement."""
        near = (0.91, 0.94, 0.96, 0.98, 0.99, 1.01, 1.02, 1.04, 1.06, 1.1)
        out: list[Shape] = [{**shape, "wavelength": shape["wavelength"] * f} for f in near]
        return [*out, {**shape, "displacement": 0.4 * shape["displacement"]}]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """Three columns: the mean force and its two quadratures."""
        axis = axis_of(site)
        z = view.sliding(axis, shape["displacement"])
        phase = 2.0 * np.pi * view.run.smooth[:, axis] / shape["wavelength"]
        parts = [view.run.to_grid(x) for x in (z, z * np.cos(phase), z * np.sin(phase))]
        return Signature({Channel(self.stage, site): column(*parts)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Mean, amplitude of the variation and its wavelength."""
        return {
            "force": float(coefficients[0]),
            "amplitude": float(np.hypot(coefficients[1], coefficients[2])),
            "wavelength": shape["wavelength"],
        }

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """The variation is a marked one."""
        return bool(np.hypot(coefficients[1], coefficients[2]) > 0.2 * abs(coefficients[0]))
