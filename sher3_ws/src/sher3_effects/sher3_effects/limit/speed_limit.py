"""Speed limit: a servo goes to its reference no faster than at a top speed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Best, Shape, Signature

from sher3_effects.operators import rate_limited
from sher3_effects.page import Page
from sher3_effects.view import AxisView


class SpeedLimit(Page):
    """position follows dx/dt = clip((reference - x) / time_constant, +-limit): error = reference - x."""

    id, family, stage = "speed_limit", "limit", "motor_mechanics"
    inputs = ("command", "velocity")
    kinds, needs = ("servo",), ("held",)
    best = Best("steps", "large and small steps separate limits from lags")
    extends = ("drive_lag",)
    leaves_out = "how it speeds up and slows down"
    explanation = (
        "After a large step of its reference the axis goes at one and the same speed, whatever the step: a profile "
        "velocity, the supply, or the back-EMF of the motor."
    )
    siblings = {"drive_lag": "a larger step is answered faster", "command_delay": "the whole reference comes late"}
    gives = ("limit", "time_constant")
    units = {"limit": "m/s", "time_constant": "s"}
    bounds = {"limit": (0.0, np.inf), "time_constant": (0.0, np.inf)}
    LEVELS = (0.7, 0.8, 0.9, 0.97, 1.0, 1.05)
    """Of the largest speed."""
    PERIODS = (1.0, 2.0, 4.0, 8.0, 16.0)
    """Time constants that are tried, in periods of the record."""
    finer = {"limit": (0.93, 0.97, 0.99, 1.01, 1.03), "time_constant": (0.7, 0.85, 1.2, 1.4)}
    MOVING, AT_TOP, MUCH = 0.2, 0.93, 0.4
    """Shares of the top speed from which the axis moves and is at its top, and of its motion that it must be there: a
    sine spends 0.28 of it there."""
    BINDS = 0.02
    """Share of the samples in which the reference must be further away than the limit reaches in its time."""

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return limits and time constants, where the reference at times runs ahead faster than the axis ever goes."""
        row, top = views[0].row(site), max(v.axis(site).top for v in views)
        errors = [np.abs(v.run.reference[:, row] - v.run.motor[:, row]) for v in views if v.run.reference is not None]
        far = np.concatenate(errors) if errors else np.zeros(1)
        period = views[0].run.period
        if not self._held(views, row):
            return []
        times = [n * period for n in self.PERIODS if np.mean(far > top * n * period) > self.BINDS]
        return [{"limit": s * top, "time_constant": t} for s in self.LEVELS for t in times if top > 0.0]

    def _held(self, views: Sequence[AxisView], row: int) -> bool:
        """Return whether the axis spends much of its motion at one speed, sample by sample; on a wave it does not."""
        speed = np.concatenate([np.abs(np.diff(v.run.motor[:, row])) / v.run.period for v in views])
        moving = speed[speed > self.MOVING * speed.max(initial=0.0)]
        return len(moving) > 0 and bool(np.mean(moving > self.AT_TOP * np.quantile(moving, 0.98)) > self.MUCH)

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return reference minus the path that follows it no faster than the limit; nothing is left to fit."""
        row, reference = view.row(site), view.run.reference
        assert reference is not None
        asked = np.ascontiguousarray(reference[:, row])
        path = rate_limited(
            asked, float(view.run.motor[0, row]), shape["limit"], shape["time_constant"], view.run.period
        )
        return Signature({}, {Channel(self.stage, site): view.run.to_grid((asked - path)[:, None])})
