"""Command jitter."""

from __future__ import annotations

from dataclasses import dataclass

from sher3_diagnosis.effect import Best
from sher3_sim.effect import EVERYWHERE, PlantEffect, parameter

from sher3_effects.page import NOWHERE, Page


class CommandJitter(Page):
    """Read off the echo tick by tick: the stage is exact and needs no fit."""

    id, family, stage = "command_jitter", "timing", "transport"
    inputs = ("command",)
    seen_at, computed = NOWHERE, "sigma"
    best = Best("steps", "steps of several amplitudes show a dead time as an onset and a lag as a slope")
    explanation = (
        "The time a command takes varies from tick to tick; the drives hold the old one a little longer or shorter."
    )
    siblings = {"drive_lag": "the echo is on time, the force is late"}


@dataclass(frozen=True)
class CommandJitterInPlant(PlantEffect, page=CommandJitter, sites=EVERYWHERE):
    """Commands arrive late by a random time, half-normal and the same for all axes of a tick; order is kept."""

    sigma: float = parameter("s", 3e-4, 0.0, 0.01, "scale of the lateness |N(0, sigma)|", on="jitter")
