"""Encoder scale: a constant ratio between the load and its encoder."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import PlantEffect, parameter

from sher3_effects.page import Page
from sher3_effects.scale.varying_ratio import gentle, lines, mean_ratio
from sher3_effects.travel import over_travel
from sher3_effects.view import RobotView


class EncoderScale(Page):
    """reading = (1 + relative) * load; the scale may vary along it, and `relative` is its mean."""

    id, family, stage = "encoder_scale", "scale", "sensing"
    inputs = ("position",)
    seen_at = (("transmission", ""),)
    breaks = "load_encoder"
    best = Best("sweep", "long constant-speed strokes separate ratios from offsets")
    leaves_out = "how the error of the scale varies from one millimetre to the next"
    explanation = (
        "The load encoder reads a little too much or too little, in proportion to the travel; the tip shows "
        "that the load is where the motor says."
    )
    siblings = {"lead_error": "the tip follows the load encoder"}

    def bends(self, views: Sequence[RobotView], site: str, shape: Shape) -> list[Shape]:
        """Return the scale that varies along the travel."""
        return over_travel(views, site, shape)

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """The position, with its bends where the scale varies, and at the tip the motion that did not happen."""
        axis = view.row(site)
        read = np.stack(lines(view.position[:, axis], shape), axis=-1)
        tip = -view.path.jacobian[:, :, [axis]] * read[:, None, :]
        return Signature({Channel("transmission", site): read[:, None, :], **view.at_tip(tip)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the ratio error: the slope of the straight line nearest to the broken one of (p,)."""
        return {"relative": mean_ratio(coefficients)}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the scale of coefficients (p,) varies by less than it is off."""
        return gentle(coefficients)


@dataclass(frozen=True)
class EncoderScaleInPlant(PlantEffect, page=EncoderScale):
    """The load encoder's scale is wrong: it reads more than the load moves."""

    relative: float = parameter("1", 1e-3, -0.05, 0.05, "reading over load travel, less one", on="encoder_scale")
