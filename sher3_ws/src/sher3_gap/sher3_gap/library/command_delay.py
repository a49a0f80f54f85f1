"""Command delay."""

from __future__ import annotations

from sher3_gap.channels import Channel
from sher3_gap.library.base import LibraryEffect


class CommandDelay(LibraryEffect):
    """Read off the echo tick by tick in `sher3_gap.timing`: the stage is exact and needs no fit."""

    id, family, stage = "command_delay", "timing", "transport"
    explanation = "A constant dead time between the host's command and the drives' demand, the same on every axis."
    siblings = {"drive_lag": "the echo is on time, the force is late"}

    def channels(self, site: str) -> tuple[Channel, ...]:
        """No residual channel: see `exact_causes`."""
        return ()
