"""Dropped commands."""

from __future__ import annotations

from sher3_gap.channels import Channel
from sher3_gap.library.base import LibraryEffect


class DroppedCommands(LibraryEffect):
    """Read off the echo tick by tick in `sher3_gap.timing`: the stage is exact and needs no fit."""

    id, family, stage = "dropped_commands", "timing", "transport"
    explanation = "Some ticks the drives hold the previous command for a whole period, as when a frame is lost."
    siblings = {"drive_lag": "the echo is on time, the force is late"}

    def channels(self, site: str) -> tuple[Channel, ...]:
        """No residual channel: see `exact_causes`."""
        return ()
