"""Encoder eccentricity: a reading error once per motor revolution."""

from __future__ import annotations

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View, axis_of, lead


class EncoderEccentricity(LibraryEffect):
    """reading = load + A sin(2 pi q / lead + phase)."""

    id, family, stage = "encoder_eccentricity", "periodic", "sensing"
    explanation = "The load encoder's reading swings once per lead while the load, and the tip, run smoothly."
    siblings = {"transmission_ripple": "the load itself moves, and the tip with it"}
    units = {"amplitude": "m", "phase": "rad"}

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Seen against the motor encoder."""
        return (Channel("transmission", site),)

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """The quadratures, and at the tip the motion that did not happen."""
        axis = axis_of(site)
        phase = 2.0 * np.pi * view.run.smooth[:, axis] / lead(view, site)
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
