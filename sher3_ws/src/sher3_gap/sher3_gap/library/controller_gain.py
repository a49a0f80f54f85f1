"""Controller gain: the host's position loop runs with another gain."""

from __future__ import annotations

from sher3_gap.channels import Channel
from sher3_gap.library.base import LibraryEffect


class ControllerGain(LibraryEffect):
    """gain = (1 + relative) * position_gain; read off the recorded commands, which the law must reproduce exactly."""

    id, family, stage = "controller_gain", "scale", "controller"
    explanation = (
        "The recorded commands are not what the host's law gives for the recorded inputs: its gain is another."
    )
    siblings = {"command_delay": "the command is right and arrives late"}

    def channels(self, site: str) -> tuple[Channel, ...]:
        """No residual channel: see `exact_causes`."""
        return ()
