"""Dropped commands."""

from __future__ import annotations

from dataclasses import dataclass

from sher3_diagnosis.effect import Best
from sher3_sim.effect import EVERYWHERE, PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.page import NOWHERE, Page


class DroppedCommands(Page):
    """Read off the echo tick by tick: the stage is exact and needs no fit."""

    id, family, stage = "dropped_commands", "timing", "transport"
    inputs = ("command",)
    seen_at, computed = NOWHERE, "probability"
    best = Best("steps", "steps of several amplitudes show a dead time as an onset and a lag as a slope")
    explanation = "Some ticks the drives hold the previous command for a whole period, as when a frame is lost."
    siblings = {"drive_lag": "the echo is on time, the force is late"}


@dataclass(frozen=True)
class DroppedCommandsInPlant(PlantEffect, page=DroppedCommands, sites=EVERYWHERE):
    """Some ticks' commands never arrive, for all axes at once; the drives hold the last command."""

    probability: float = parameter("1", 0.01, 0.0, 0.9, "chance that the command of a tick is lost")

    def apply(self, p: PlantParameters) -> None:
        """Lose commands."""
        p.axis["drop"][self.rows] = 1.0 - (1.0 - p.axis["drop"][self.rows]) * (1.0 - self.probability)
