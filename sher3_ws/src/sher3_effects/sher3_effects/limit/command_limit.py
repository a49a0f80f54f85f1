"""Limit of a controller: its command is clipped below what was stated."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Best, Shape, Signature

from sher3_effects.page import Page
from sher3_effects.view import LawView


class CommandLimit(Page):
    """command = clamp(law, +-limit)."""

    id, family, stage = "command_limit", "limit", "controller"
    kinds = ("law",)
    inputs = ("command",)
    best = Best("steps", "large and small steps separate limits from gains")
    explanation = "The command stops rising at a level that nobody stated; below it the law holds."
    siblings = {"controller_gain": "small commands are too small as well"}
    gives = ("limit",)
    units = {"limit": "1"}
    NEAR = (0.9, 0.97, 1.0, 1.03, 1.1)
    """Limits that are tried, over the largest command that was recorded."""
    finer = {"limit": (0.97, 0.99, 0.995, 1.005, 1.01, 1.03)}

    def shapes(self, views: Sequence[LawView], site: str) -> list[Shape]:
        """Return limits around the largest command that was recorded, in its unit."""
        largest = max(float(np.abs(v.run.command).max()) for v in views)
        return [{"limit": x * largest} for x in self.NEAR if largest]

    def signature(self, view: LawView, site: str, shape: Shape) -> Signature:
        """Return the clipped law less the law; nothing is left to fit."""
        law = view.stated.command
        lost = np.clip(law, -shape["limit"], shape["limit"]) - law
        return Signature({}, {Channel(self.stage, site): view.run.to_grid(lost[:, None])})
