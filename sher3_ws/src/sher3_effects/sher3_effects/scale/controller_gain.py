"""Controller gain: the host's position loop runs with another gain."""

from __future__ import annotations

from dataclasses import dataclass

from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Best
from sher3_sim.effect import EVERYWHERE, PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.page import Page


class ControllerGain(Page):
    """gain = (1 + relative) * position_gain; read off the recorded commands, which the law must reproduce exactly."""

    id, family, stage = "controller_gain", "scale", "controller"
    inputs = ("command", "position")
    best = Best("sweep", "long constant-speed strokes separate ratios from offsets")
    explanation = (
        "The recorded commands are not what the host's law gives for the recorded inputs: its gain is another."
    )
    siblings = {"command_delay": "the command is right and arrives late"}

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Return none: the exact stage is judged without residuals."""
        return ()


@dataclass(frozen=True)
class ControllerGainInPlant(PlantEffect, page=ControllerGain, sites=EVERYWHERE):
    """The host's position gain is not the one configured: wrong unit, wrong file, rounding."""

    relative: float = parameter("1", 0.1, -0.9, 4.0, "gain over nominal gain, less one")

    def apply(self, p: PlantParameters) -> None:
        """Scale the position gain."""
        p.axis["position_gain"][self.rows] *= 1.0 + self.relative
