"""What was found on one axis of a machine."""

from __future__ import annotations

from dataclasses import dataclass, field

from sher3_gap.attribute import Attribution
from sher3_gap.channels import Channel
from sher3_gap.localise import Gap
from sher3_gap.machines.axis_evidence import AxisEvidence
from sher3_gap.machines.description import Axis
from sher3_gap.machines.replay import Replay
from sher3_gap.verdict import Cause

UNITS = {
    ("linear", "motor_mechanics"): "N",
    ("rotary", "motor_mechanics"): "N*m",
    ("linear", "transmission"): "m",
    ("rotary", "transmission"): "rad",
}


@dataclass
class AxisFinding:
    """What was found on one axis."""

    axis: Axis
    evidence: AxisEvidence
    gaps: dict[Channel, Gap]
    attribution: Attribution
    causes: list[Cause]
    open: dict[Channel, float]
    notes: list[str] = field(default_factory=list)
    replay: Replay | None = None


def unit_of(axis: Axis, stage: str) -> str:
    """Unit of a channel; a servo's error is a position."""
    return UNITS[axis.motion, "transmission" if axis.command_law.kind == "position" else stage]
