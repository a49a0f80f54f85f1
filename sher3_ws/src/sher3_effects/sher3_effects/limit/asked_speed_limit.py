"""Speed limit under a loop of the speed: what it misses of the place is not caught up with."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature

from sher3_effects.limit.speed_limit import SpeedLimit
from sher3_effects.page import Page
from sher3_effects.view import AxisView


class SpeedLimitOfLoop(Page):
    """speed = clip(asked speed, +-limit): error = the sum of what is missed."""

    id, family, stage = SpeedLimit.id, SpeedLimit.family, SpeedLimit.stage
    kinds, needs = ("servo",), ("asked speed",)
    inputs = ("command",)
    best = Best("steps", "asked speeds below and above a limit separate it from a share")
    explanation = "The axis goes as fast as it is asked up to a top speed: the supply, or the back-EMF of the motor."
    siblings = {
        "reference_scale": "slow references are followed by the same share too slowly",
        "drive_lag": "a steady speed is reached",
    }
    gives = ("limit",)
    units = {"limit": "m/s"}
    bounds = {"limit": (0.0, np.inf)}
    LEVELS = SpeedLimit.LEVELS
    """Of the largest speed."""
    finer = {"limit": (0.93, 0.97, 0.99, 1.01, 1.03)}
    BEYOND, BELOW = 0.2, 0.02
    """Shares of the samples in which more must be asked than the limit, which what a loop overshoots by does not reach,
    and less, without which it may be a share as well."""

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return limits of which more is asked for a while, and less of it."""
        row, top = views[0].row(site), max(v.axis(site).top for v in views)
        speeds = [np.abs(self._steps(v, row)) / v.run.period for v in views]
        asked = np.concatenate(speeds)
        slower = [np.mean((asked > 0.0) & (asked < s * top)) > self.BELOW for s in self.LEVELS]
        faster = [np.mean(asked > s * top) > self.BEYOND for s in self.LEVELS]
        both = [s for s, less, more in zip(self.LEVELS, slower, faster, strict=True) if less and more]
        return [{"limit": s * top} for s in both]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return the asked place minus what speeds within the limit add up to; nothing is left to fit."""
        steps, most = self._steps(view, view.row(site)), shape["limit"] * view.run.period
        missed = np.cumsum(steps - np.clip(steps, -most, most))
        return Signature({}, {Channel(self.stage, site): view.run.to_grid(missed[:, None])})

    @staticmethod
    def _steps(view: AxisView, row: int) -> Array:
        """Return what is asked for in each sample, (n,) m or rad."""
        assert view.run.reference is not None
        return np.diff(view.run.reference[:, row], prepend=view.run.reference[:1, row])
