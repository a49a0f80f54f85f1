"""Axis skew."""

from __future__ import annotations

from dataclasses import dataclass

from sher3_diagnosis.effect import Best
from sher3_sim.effect import PlantEffect, parameter

from sher3_effects.page import NOWHERE, Page


class AxisSkew(Page):
    """Read off the echo tick by tick: the stage is exact and needs no fit."""

    id, family, stage = "axis_skew", "timing", "transport"
    inputs = ("command",)
    seen_at, computed = NOWHERE, "skew"
    best = Best("steps", "steps of several amplitudes show a dead time as an onset and a lag as a slope")
    explanation = "One drive acts later than the others by a constant: a straight line in space becomes a hook."
    siblings = {"drive_lag": "the echo is on time, the force is late"}


@dataclass(frozen=True)
class AxisSkewInPlant(PlantEffect, page=AxisSkew):
    """One axis acts later than the others: its frame is the last of the bus cycle."""

    skew: float = parameter("s", 1e-3, 0.0, 0.03, "lateness against the other axes", on="delay")
