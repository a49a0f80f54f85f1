"""Encoder eccentricity: a reading error once per motor revolution."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import PlantEffect, parameter, set_to

from sher3_effects.page import Page
from sher3_effects.periodic.phase import phase_at_zero
from sher3_effects.view import AxisView, RobotView


class EncoderEccentricity(Page):
    """reading = load + A sin(2 pi q / lead + phase), and the same of twice the order where the code is tilted too."""

    id, family, stage = "encoder_eccentricity", "periodic", "sensing"
    inputs = ("position",)
    tried = ({"side": 0.0}, {"side": 2.0})
    """Once per lead, alone (0) or with a second harmonic (2)."""
    seen_at = (("transmission", ""),)
    breaks = "load_encoder"
    best = Best("sweep", "constant speeds over several revolutions separate periods")
    leaves_out = "further harmonics"
    explanation = "The load encoder's reading swings once per lead while the load, and the tip, run smoothly."
    siblings = {"transmission_ripple": "the load itself moves, and the tip with it"}

    def _waves(self, view: AxisView, site: str, shape: Shape) -> Array:
        """Quadratures at every tick, (n, p)."""
        turn = 2.0 * np.pi * view.run.smooth[:, view.row(site)] / shape.get("turn", view.lead(site))
        orders = (1.0, shape["side"]) if shape["side"] else (1.0,)
        return np.stack([f(n * turn) for n in orders for f in (np.sin, np.cos)], axis=-1)

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """The quadratures, and at the tip the motion that did not happen."""
        waves = self._waves(view, site, shape)
        tip = -view.path.jacobian[:, :, [view.row(site)]] * waves[view.run.grid][:, None, :]
        return Signature({Channel("transmission", site): view.run.to_grid(waves)[:, None, :], **view.at_tip(tip)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return amplitude and phase [rad], of the first two of (p,)."""
        return {
            "amplitude": float(np.hypot(coefficients[0], coefficients[1])),
            "phase": float(np.arctan2(coefficients[1], coefficients[0])),
        }

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether once per lead is the larger wave of coefficients (2,) or (4,).

        The second belongs to a code disc that is tilted as well.
        """
        return len(coefficients) < 4 or bool(np.hypot(*coefficients[:2]) > np.hypot(*coefficients[2:]))


class EccentricityOnAxis(EncoderEccentricity):
    """The same on one axis of any machine, whose tip nobody sees."""

    kinds = ("axis", "servo")
    needs = ("load",)
    discrete = frozenset({"turn"})
    units = {"amplitude": "m", "turn": "m"}
    TURNS = 0.75
    """Whole turns of a load that must be recorded before once per turn is told from a bend."""

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return once per motor revolution where that is known, and once per turn of a load that turns."""
        axes, found = [v.axis(site) for v in views], []
        if axes[0].lead_known:
            found += super().shapes(views, site)
        if axes[0].rotary and max(a.travel for a in axes) > self.TURNS * 2.0 * np.pi:
            found += [{"side": s, "turn": 2.0 * np.pi} for s in (0.0, 2.0)]
        return found

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return amplitude and phase [rad], of the first two of (p,), and the turn where the load's turn counts."""
        turn = {"turn": shape["turn"]} if "turn" in shape else {}
        return {**super().parameters(shape, coefficients), **turn}

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return the quadratures of the reading."""
        waves = view.run.to_grid(self._waves(view, site, shape))
        return Signature({Channel("transmission", site): waves[:, None, :]})


@dataclass(frozen=True)
class EncoderEccentricityInPlant(PlantEffect, page=EncoderEccentricity):
    """The load encoder's code is off centre and reads ahead and behind once per lead; the load itself does not move."""

    amplitude: float = parameter("m", 3e-6, 0.0, 1e-3, "of the reading", on="eccentricity", change=set_to)
    phase: float = phase_at_zero("eccentricity_phase")
