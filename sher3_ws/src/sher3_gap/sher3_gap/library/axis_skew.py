"""Axis skew."""

from __future__ import annotations

from sher3_gap.channels import Channel
from sher3_gap.library.base import LibraryEffect


class AxisSkew(LibraryEffect):
    """Read off the echo tick by tick in `sher3_gap.timing`: the stage is exact and needs no fit."""

    id, family, stage = "axis_skew", "timing", "transport"
    explanation = "One drive acts later than the others by a constant: a straight line in space becomes a hook."
    siblings = {"drive_lag": "the echo is on time, the force is late"}

    def channels(self, site: str) -> tuple[Channel, ...]:
        """No residual channel: see `exact_causes`."""
        return ()
