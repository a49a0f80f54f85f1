"""Dead zone of a controller: errors within a width are not answered."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Best, Shape, Signature

from sher3_effects.page import Page
from sher3_effects.view import LawView


class CommandDeadband(Page):
    """command = law of an error that is 0 within +-width (jump), or less by the width beyond it (soft)."""

    id, family, stage = "command_deadband", "limit", "controller"
    kinds = ("law",)
    inputs = ("position", "command")
    best = Best("steps", "large and small steps separate a dead zone from a gain")
    explanation = "The controller does not answer errors within a width that nobody stated."
    siblings = {
        "controller_gain": "small and large errors are answered less in proportion",
        "coulomb_friction": "the command answers, and the axis does not; without a recorded command the same readings",
    }
    gives = ("width",)
    units = {"width": "m"}
    discrete = frozenset({"soft"})
    QUANTILES = (0.05, 0.15, 0.3, 0.45, 0.6, 0.75, 0.88)
    """Quantiles of the error's size that are tried as the width."""
    finer = {"width": (0.75, 0.85, 0.92, 0.97, 1.03, 1.08, 1.18, 1.35)}

    def shapes(self, views: Sequence[LawView], site: str) -> list[Shape]:
        """Return half widths, m or rad, each with a jump (0) and soft (1)."""
        error = np.concatenate([np.abs(v.stated.error) for v in views])
        widths = sorted({float(w) for w in np.quantile(error, self.QUANTILES)} - {0.0})
        return [{"width": w, "soft": s} for w in widths for s in (0.0, 1.0)]

    def signature(self, view: LawView, site: str, shape: Shape) -> Signature:
        """Return the law of the error that is seen less the law; nothing is left to fit."""
        law, width = view.stated, shape["width"]
        unseen = np.clip(law.error, -width, width)
        if not shape["soft"]:
            unseen = np.where(np.abs(law.error) < width, law.error, 0.0)
        changed = law.clipped(law.parts.sum(axis=1) - law.gain * unseen) - law.command
        return Signature({}, {Channel(self.stage, site): view.run.to_grid(changed[:, None])})
