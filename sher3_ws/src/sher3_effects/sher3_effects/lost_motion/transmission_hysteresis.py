"""Transmission hysteresis: the load lags by an amount that builds up over a stroke."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_sim.effect import PlantEffect, parameter, set_to

from sher3_effects.operators import dahl_turned
from sher3_effects.page import Page
from sher3_effects.view import AxisView


class TransmissionHysteresis(Page):
    """load = motor - amplitude * z, z a Dahl state over `displacement`."""

    id, family, stage = "transmission_hysteresis", "lost_motion", "transmission"
    inputs: ClassVar[tuple[str, ...]] = ("direction",)
    kinds: ClassVar[tuple[str, ...]] = ("robot",)
    needs = ("load",)
    best = Best("loads", "known loads at rest separate a fixed gap from a spring")
    leaves_out = "the shape of its loops"
    companion = "friction"
    explanation = (
        "Going and coming differ by a fixed amount that builds up gradually after each reversal (harmonic drive, belt)."
    )
    siblings = {
        "backlash": "the load stays at rest, then follows at once",
        "transmission_compliance": "in proportion to the force",
    }
    units: ClassVar[Mapping[str, str]] = {"amplitude": "m"}
    DISPLACEMENTS = (0.002, 0.005, 0.01, 0.02, 0.04, 0.08, 0.16, 0.32, 0.64)
    """In motor revolutions."""
    finer: ClassVar[Mapping[str, tuple[float, ...]]] = {"displacement": (0.7, 0.85, 1.2, 1.4)}

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Displacement over which the lag builds up."""
        return [{"displacement": d * views[0].lead(site)} for d in self.DISPLACEMENTS]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """One column: minus the Dahl state."""
        z = view.run.to_grid(view.sliding(view.row(site), shape["displacement"]))
        return Signature({Channel(self.stage, site): column(-z)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return half the width of the loop (1,) and its displacement; `width` is the whole loop."""
        a = float(coefficients[0])
        return {"amplitude": a, "width": 2.0 * a, "displacement": shape["displacement"]}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the load lags, by (1,), and by less than the stroke over which the lag builds up."""
        return bool(0.0 < coefficients[0] < shape["displacement"])


class HysteresisOnAxis(TransmissionHysteresis):
    """The same on one axis of any machine; where a force was recorded, friction may lie beside the spring itself.

    Then the loop follows the force and no path: twist = (force - friction * z) / stiffness, z a Dahl state of the
    force, so that the load leads what the spring alone would give by `amplitude` after the force grew.
    """

    kinds = ("axis", "servo")
    inputs = ("direction", "loading")
    units = {"amplitude": "m", "reach": "N"}
    REACHES = (0.03, 0.06, 0.12, 0.25, 0.5, 1.0)
    """Forces over which a loop builds up, over the rms one."""
    finer = {**TransmissionHysteresis.finer, "reach": (0.7, 0.85, 1.2, 1.4)}

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return displacements, and forces over which the loop builds up where they were recorded."""
        force = [v.run.effort[:, v.row(site)] for v in views if v.run.effort is not None]
        usual = float(np.sqrt(np.mean([np.mean(x**2) for x in force]))) if force else 0.0
        return [*super().shapes(views, site), *({"reach": r * usual} for r in self.REACHES if usual)]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return minus the Dahl state of the path, or that state of the force."""
        if "reach" not in shape:
            return super().signature(view, site, shape)
        run = view.run
        assert run.effort is not None
        force = np.ascontiguousarray(run.filtered(run.effort)[:, view.row(site)])
        z = dahl_turned(force, np.gradient(force, run.period), shape["reach"], run.period)
        return Signature({Channel(self.stage, site): column(run.to_grid(z[:, None])[:, 0])})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return half the width of the loop (1,), the whole, and the path or the force that it builds up over."""
        a = float(coefficients[0])
        over = {"reach": shape["reach"]} if "reach" in shape else {"displacement": shape["displacement"]}
        return {"amplitude": a, "width": 2.0 * a, **over}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the load lags, by (1,), over a path by less than the stroke over which the lag builds up."""
        return bool(coefficients[0] > 0.0) if "reach" in shape else super().admissible(shape, coefficients)


@dataclass(frozen=True)
class TransmissionHysteresisInPlant(PlantEffect, page=TransmissionHysteresis):
    """After a reversal the load lags and catches up gradually: friction inside an elastic transmission."""

    width: float = parameter("m", 5e-6, 0.0, 1e-3, "of the loop, between the two directions", on="hysteresis")
    displacement: float = parameter(
        "m", 20e-6, 1e-8, 1e-2, "travel over which it turns to 1/e", on="hysteresis_displacement", change=set_to
    )
