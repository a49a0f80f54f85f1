"""Encoder eccentricity: a reading error once per motor revolution."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.page import Page
from sher3_effects.periodic.phase import phase_at_zero
from sher3_effects.view import AxisView, RobotView


class EncoderEccentricity(Page):
    """reading = load + A sin(2 pi q / lead + phase)."""

    id, family, stage = "encoder_eccentricity", "periodic", "sensing"
    inputs = ("position",)
    breaks = "load_encoder"
    best = Best("sweep", "constant speeds over several revolutions separate periods")
    explanation = "The load encoder's reading swings once per lead while the load, and the tip, run smoothly."
    siblings = {"transmission_ripple": "the load itself moves, and the tip with it"}

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Return the difference of the two encoders."""
        return (Channel("transmission", site),)

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """The quadratures, and at the tip the motion that did not happen."""
        axis = view.row(site)
        phase = 2.0 * np.pi * view.run.smooth[:, axis] / view.lead(site)
        waves = np.stack([view.run.to_grid(np.sin(phase)), view.run.to_grid(np.cos(phase))], axis=-1)
        raw = np.stack([np.sin(phase), np.cos(phase)], axis=-1)[view.run.grid]
        tip = -view.path.jacobian[:, :, [axis]] * raw[:, None, :]
        return Signature({Channel("transmission", site): waves[:, None, :], **view.at_tip(tip)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Amplitude and phase."""
        return {
            "amplitude": float(np.hypot(*coefficients)),
            "phase": float(np.arctan2(coefficients[1], coefficients[0])),
        }


class EccentricityOnAxis(EncoderEccentricity):
    """The same on one axis of any machine, whose tip nobody sees."""

    kinds = ("axis", "servo")
    needs = ("load", "lead")

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return the quadratures of the reading."""
        phase = 2.0 * np.pi * view.run.smooth[:, view.row(site)] / view.lead(site)
        waves = column(view.run.to_grid(np.sin(phase)), view.run.to_grid(np.cos(phase)))
        return Signature({Channel("transmission", site): waves})


@dataclass(frozen=True)
class EncoderEccentricityInPlant(PlantEffect, page=EncoderEccentricity):
    """The load encoder's code is off centre and reads ahead and behind once per lead; the load itself does not move."""

    amplitude: float = parameter("m", 3e-6, 0.0, 1e-3, "of the reading")
    phase: float = phase_at_zero()

    def apply(self, p: PlantParameters) -> None:
        """Add the reading error."""
        p.axis["eccentricity"][self.rows] = self.amplitude
        p.axis["eccentricity_phase"][self.rows] = self.phase
