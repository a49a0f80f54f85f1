"""In which regimes a gap lives: rms over floor by motion, direction, speed, load and excitation."""

from __future__ import annotations

from typing import NamedTuple

from sher3_diagnosis.channel import Channel
from sher3_diagnosis.localise.regimes import regime_powers
from sher3_diagnosis.machine import Diagnosis

SHOWN = 4
"""Channels shown, those with the largest gap."""
ROWS = 10
"""Regimes shown of a channel, those with the largest gap."""
ABOVE_FLOOR = 1.16
"""Rms over floor from which a regime is coloured as one with a gap: the power of a gap that is just significant."""
SHORTEST = 1.5
"""Rms over floor that a full bar stands for at least, so that regimes at the floor do not look large."""


class Regimes(NamedTuple):
    """Rms over floor of a channel by regime, largest first; what a full bar stands for, and where a gap begins."""

    at: Channel
    ratios: list[tuple[str, float]]
    full: float
    gap_from: float = ABOVE_FLOOR


def regimes(diagnosis: Diagnosis) -> list[Regimes]:
    """Return the regimes of the channels with a gap."""
    gaps = [(g, f.evidence) for f in diagnosis.findings for g in f.gaps if g.significant]
    out = []
    for gap, evidence in sorted(gaps, key=lambda pair: -pair[0].power)[:SHOWN]:
        powers = regime_powers(evidence, gap.channel)
        ratios = sorted(((n, p**0.5) for n, p in powers.items()), key=lambda x: -x[1])[:ROWS]
        out.append(Regimes(gap.channel, ratios, max((SHORTEST, *(r for _, r in ratios)))))
    return out
