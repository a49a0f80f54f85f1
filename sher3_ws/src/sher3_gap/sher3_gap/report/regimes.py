"""In which regimes a gap lives: power over floor by motion, direction, speed, load, excitation."""

from __future__ import annotations

from dataclasses import dataclass

from sher3_gap.diagnose import Diagnosis
from sher3_gap.regimes import regime_powers
from sher3_gap.report.style import STAGE_NAMES, place

SHOWN = 4
ROWS = 10
"""Regimes shown of a channel, those with the largest gap."""


@dataclass(frozen=True)
class Row:
    """One regime: its rms over the floor, and the length of its bar in percent."""

    name: str
    ratio: float
    width: float
    gap: bool


@dataclass(frozen=True)
class Regimes:
    """The regimes of one channel, largest first."""

    title: str
    rows: list[Row]


def regimes(diagnosis: Diagnosis) -> list[Regimes]:
    """Return the regimes of the channels with a gap."""
    out = []
    for gap in [g for g in diagnosis.gaps if g.significant][:SHOWN]:
        powers = regime_powers(diagnosis.evidence, gap.channel)
        ratios = sorted(((n, p**0.5) for n, p in powers.items()), key=lambda x: -x[1])[:ROWS]
        top = max((r for _, r in ratios), default=1.0)
        rows = [Row(n, r, 100.0 * r / max(top, 1.5), r > 1.16) for n, r in ratios]
        out.append(Regimes(f"{STAGE_NAMES[gap.channel.stage]}, {place(gap.channel.actuator)}", rows))
    return out
