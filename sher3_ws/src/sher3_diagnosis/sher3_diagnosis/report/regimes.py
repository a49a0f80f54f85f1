"""In which regimes a gap lives: rms over floor by motion, direction, speed, load and excitation."""

from __future__ import annotations

from dataclasses import dataclass

from sher3_diagnosis.localise.regimes import regime_powers
from sher3_diagnosis.machine import Diagnosis
from sher3_diagnosis.words import place, words

SHOWN = 4
"""Channels shown, those with the largest gap."""
ROWS = 10
"""Regimes shown of a channel, those with the largest gap."""
ABOVE_FLOOR = 1.16
"""Rms over floor from which a regime is coloured as one with a gap: the power of a gap that is just significant."""
SHORTEST = 1.5
"""Rms over floor that a full bar stands for at least, so that regimes at the floor do not look large."""


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
    gaps = [(g, f.evidence) for f in diagnosis.findings for g in f.gaps if g.significant]
    out = []
    for gap, evidence in sorted(gaps, key=lambda pair: -pair[0].power)[:SHOWN]:
        powers = regime_powers(evidence, gap.channel)
        ratios = sorted(((n, p**0.5) for n, p in powers.items()), key=lambda x: -x[1])[:ROWS]
        top = max((r for _, r in ratios), default=1.0)
        rows = [Row(n, r, 100.0 * r / max(top, SHORTEST), r > ABOVE_FLOOR) for n, r in ratios]
        out.append(Regimes(f"{words(gap.channel.stage)}, {place(gap.channel.actuator)}", rows))
    return out
