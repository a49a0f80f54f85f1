"""Units of the robot's residual channels, and where its effects may sit."""

from __future__ import annotations

from collections.abc import Mapping

from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import ROTARY
from sher3_sim.effect import SITES

UNITS = {
    "transport": "m/s",
    "controller": "m/s",
    "drive": "N",
    "motor_mechanics": "N",
    "transmission": "m",
    "mechanism": "m",
    "structure": "m",
    "sensing": "N",
}
"""Stage -> unit of its first component on a linear axis."""
ROTARY_AXES = frozenset({"roll"})
"""Actuators that turn."""
PLACES: Mapping[str, tuple[str, ...]] = SITES
"""Kind of place -> sites of the robot."""
TIP, LOADED_TIP = Channel("mechanism", "tip"), Channel("structure", "tip")


def unit_of(channel: Channel) -> str:
    """Return the unit of the first component of a channel."""
    unit = UNITS[channel.stage]
    return ROTARY.get(unit, unit) if channel.actuator in ROTARY_AXES else unit
