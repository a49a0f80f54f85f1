"""Command jitter."""

from __future__ import annotations

from sher3_gap.channels import Channel
from sher3_gap.library.base import LibraryEffect


class CommandJitter(LibraryEffect):
    """Read off the echo tick by tick in `sher3_gap.timing`: the stage is exact and needs no fit."""

    id, family, stage = "command_jitter", "timing", "transport"
    explanation = (
        "The time a command takes varies from tick to tick; the drives hold the old one a little longer or shorter."
    )
    siblings = {"drive_lag": "the echo is on time, the force is late"}

    def channels(self, site: str) -> tuple[Channel, ...]:
        """No residual channel: see `exact_causes`."""
        return ()
