"""Transmission hysteresis: the load lags by an amount that builds up over a stroke."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of, column, lead


class TransmissionHysteresis(LibraryEffect):
    """load = motor - amplitude * z, z a Dahl state over `displacement`."""

    id, family, stage = "transmission_hysteresis", "lost_motion", "transmission"
    explanation = (
        "Going and coming differ by a fixed amount that builds up gradually after each reversal (harmonic drive, belt)."
    )
    siblings = {
        "backlash": "the load stands still, then follows at once",
        "transmission_compliance": "in proportion to the force",
    }
    units = {"amplitude": "m", "displacement": "m"}
    DISPLACEMENTS = (0.002, 0.005, 0.01, 0.02, 0.04, 0.08, 0.16, 0.32, 0.64)
    """In motor revolutions."""

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """Displacement over which the lag builds up."""
        return [{"displacement": d * lead(views[0], site)} for d in self.DISPLACEMENTS]

    def refine(self, shape: Shape) -> list[Shape]:
        """Between the neighbours."""
        return [{"displacement": shape["displacement"] * f} for f in (0.7, 0.85, 1.2, 1.4)]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """One column: minus the Dahl state."""
        z = view.run.to_grid(view.sliding(axis_of(site), shape["displacement"]))
        return Signature({Channel(self.stage, site): column(-z)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Half the width of the loop and its displacement; `width` is the whole loop."""
        a = float(coefficients[0])
        return {"amplitude": a, "width": 2.0 * a, "displacement": shape["displacement"]}

    def unit(self, name: str, site: str) -> str:
        """All lengths."""
        return "rad" if site == "roll" else "m"

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """The load lags behind, and by less than the stroke over which the lag builds up."""
        return bool(0.0 < coefficients[0] < shape["displacement"])
