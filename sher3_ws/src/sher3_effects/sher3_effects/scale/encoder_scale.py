"""Encoder scale: a constant ratio between the load and its encoder."""

from __future__ import annotations

from dataclasses import dataclass

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.page import Page
from sher3_effects.view import RobotView


class EncoderScale(Page):
    """reading = (1 + relative) * load."""

    id, family, stage = "encoder_scale", "scale", "sensing"
    inputs = ("position",)
    breaks = "load_encoder"
    best = Best("sweep", "long constant-speed strokes separate ratios from offsets")
    leaves_out = "how the error of the scale varies along it"
    explanation = (
        "The load encoder reads a little too much or too little, in proportion to the travel; the tip shows "
        "that the load is where the motor says."
    )
    siblings = {"lead_error": "the tip follows the load encoder"}

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Return the difference of the two encoders."""
        return (Channel("transmission", site),)

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """The position, and at the tip the motion that did not happen."""
        axis = view.row(site)
        q = view.position[:, axis]
        tip = -view.path.jacobian[:, :, [axis]] * q[:, None, None]
        return Signature({Channel("transmission", site): column(q), **view.at_tip(tip)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Ratio error."""
        return {"relative": float(coefficients[0])}


@dataclass(frozen=True)
class EncoderScaleInPlant(PlantEffect, page=EncoderScale):
    """The load encoder's scale is wrong: it reads more than the load moves."""

    relative: float = parameter("1", 1e-3, -0.05, 0.05, "reading over load travel, less one")

    def apply(self, p: PlantParameters) -> None:
        """Scale the load encoder."""
        p.axis["encoder_scale"][self.rows] += self.relative
