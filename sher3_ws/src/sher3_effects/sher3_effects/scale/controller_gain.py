"""Controller gain: the host's position loop runs with another gain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_sim.effect import EVERYWHERE, PlantEffect, parameter, scaled_by

from sher3_effects.page import NOWHERE, Page
from sher3_effects.view import LawView


class ControllerGain(Page):
    """gain = (1 + relative) * position_gain; read off the recorded commands, which the law must reproduce exactly."""

    id, family, stage = "controller_gain", "scale", "controller"
    inputs = ("command", "position")
    seen_at, computed = NOWHERE, "relative"
    best = Best("sweep", "long constant-speed strokes separate ratios from offsets")
    explanation = (
        "The recorded commands are not what the host's law gives for the recorded inputs: its gain is another."
    )
    siblings = {"command_delay": "the command is right and arrives late"}


class GainOfLaw(ControllerGain):
    """command = (1 + relative) times the stated law, or times one of its parts."""

    kinds = ("law",)
    seen_at = (("", ""),)
    indistinct = ("torque_constant",)
    above = -1.0
    """Relative change at which nothing of a gain is left: what answers the other way round is no gain."""
    discrete = frozenset({"part"})
    on_axis = {"relative": "servo", "position_relative": "servo_position", "velocity_relative": "servo_velocity"}
    siblings = {
        "command_delay": "the command is right and arrives late",
        "command_deadband": "small errors do nothing, large ones are answered less by a constant",
    }
    explanation = "The recorded command is the stated law with another gain, of all of it or of one part."
    PARTS = ("position", "velocity", "integral")
    """Parts of a law, in the order of its columns."""

    def shapes(self, views: Sequence[LawView], site: str) -> list[Shape]:
        """Return all of the law (-1), or one of its parts where there are several."""
        there = [k for k in range(len(self.PARTS)) if any(v.stated.parts[:, k].any() for v in views)]
        return [{"part": float(k)} for k in ((-1, *there) if len(there) > 1 else (-1,))]

    def signature(self, view: LawView, site: str, shape: Shape) -> Signature:
        """Return one column: the part, where the command is not at its limit."""
        law, part = view.stated, int(shape["part"])
        all_of_it = law.parts.sum(axis=1)
        chosen = all_of_it if part < 0 else law.parts[:, part]
        free = np.abs(all_of_it) < law.limit
        return Signature({self.channels(site)[0]: column(view.run.to_grid((chosen * free)[:, None])[:, 0])})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the relative change (1,), named after its part."""
        part = int(shape["part"])
        return {"relative" if part < 0 else f"{self.PARTS[part]}_relative": float(coefficients[0])}


@dataclass(frozen=True)
class ControllerGainInPlant(PlantEffect, page=ControllerGain, sites=EVERYWHERE):
    """The host's position gain is not the one configured: wrong unit, wrong file, rounding."""

    relative: float = parameter(
        "1", 0.1, -0.9, 4.0, "gain over nominal gain, less one", on="position_gain", change=scaled_by
    )
