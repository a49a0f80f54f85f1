"""Where the gap is: gap over floor per channel, over all runs and excitation by excitation."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sher3_gap.channels import Array, Channel, partly_free, relieved, restored
from sher3_gap.evidence import Evidence
from sher3_gap.signals import RunSignals

POOLED = {
    "drive": 1.3,
    "motor_mechanics": 1.3,
    "transmission": 1.25,
    "mechanism": 2.0,
    "structure": 2.0,
    "sensing": 1.35,
}
"""Power over allowance, over all runs, from which a channel has a gap, with a floor from many repeats.

At the tip a robot as built may be off by as much as the floor, which no repeat shows.
"""
FLOOR_SCATTER = 0.5
"""Share by which the thresholds rise per degree of freedom of the floor: what differs from run to run is known from few
runs, and a floor that came out small by chance is no gap."""
GROUPED = 2.5
"""The same for the runs of one excitation: fewer samples, and more of them looked at."""
GROUPED_ENCODERS = 3.0
"""The same for the difference of two encoders, of which a slow run has few independent roundings."""
AS_BUILT = {"sensing": np.array([1.0e-3] * 3 + [1.2e-5] * 3)}
"""What a healthy force sensor may deviate from its drawing, which no repeat shows: N and N m."""
ZERO_COUNTS = 0.75
"""Mean difference of two encoders, in counts of the motor's, from which it is a gap: rounding alone moves a run's mean
by up to half a count."""
PARTS = {6: (slice(0, 3), slice(3, 6)), 1: (slice(0, 1),)}
"""Components that are judged together: position and rotation, force and torque."""


@dataclass(frozen=True)
class Gap:
    """Gap and floor of one channel.

    Attributes:
        power: mean square over its allowance (floor, and as-built tolerance where there is one), the larger of
            pooled and worst group,
            each over its threshold: above 1 there is a gap.
        ratio: rms gap over rms floor, over all runs of the worst part.
        gap, floor: rms in SI units of that part.
        groups: excitation -> power over floor.
    """

    channel: Channel
    power: float
    ratio: float
    gap: float
    floor: float
    groups: Mapping[str, float]

    @property
    def significant(self) -> bool:
        """Whether the gap exceeds its floor."""
        return self.power > 1.0


def gap_of(evidence: Evidence, channel: Channel, residual: Mapping[int, Array] | None = None) -> Gap | None:
    """Gap of a channel, of its nominal residual or of another one {run: (N_ok, d)}; None where it was not recorded."""
    tolerance = AS_BUILT.get(channel.stage)
    left: list[Array] = []
    square: dict[str, list[Array]] = defaultdict(list)
    allowed: dict[str, list[Array]] = defaultdict(list)
    floor: dict[str, list[Array]] = defaultdict(list)
    for r, run in enumerate(evidence.runs):
        found = evidence.data.residuals[r].get(channel)
        if found is None or not found.ok.any():
            continue
        values = relieved(channel, found.values[found.ok]) if residual is None else residual[r]
        left.append(values)
        base = evidence.floors[r][channel] ** 2
        square[run.excitation].append(np.mean(values**2, axis=0))
        floor[run.excitation].append(base)
        allowed[run.excitation].append(base + (tolerance**2 if tolerance is not None else 0.0))
    if not square:
        return None
    parts = PARTS[len(base)]
    rise = 1.0 + FLOOR_SCATTER / max(repeats(evidence.runs), 1)
    best = max((_part(channel, p, square, floor, allowed, rise) for p in parts), key=lambda g: g.power)
    return _with_zeros(evidence, channel, left, best) if partly_free(channel) else best


def _with_zeros(evidence: Evidence, channel: Channel, left: Sequence[Array], best: Gap) -> Gap:
    """Judge the runs' mean encoder difference as well, against what their zeros may differ by; `left` is relieved."""
    means = [float(restored(channel, values).mean()) for values in left]
    mean, limit = float(np.sqrt(np.mean(np.square(means)))), ZERO_COUNTS * evidence.count(channel)
    if (mean / limit) ** 2 <= best.power:
        return best
    return replace(best, power=(mean / limit) ** 2, gap=mean, floor=limit / 3.0, ratio=3.0 * mean / limit)


def repeats(runs: Sequence[RunSignals]) -> int:
    """Degrees of freedom of the repeat floor: runs beyond the first of each excitation."""
    return len(runs) - len({run.excitation for run in runs})


def _part(channel: Channel, part: slice, square: Mapping, floor: Mapping, allowed: Mapping, rise: float) -> Gap:
    every = [x for xs in square.values() for x in xs]
    base = [x for xs in floor.values() for x in xs]
    limits = [x for xs in allowed.values() for x in xs]
    mean, low, limit = (np.mean(x, axis=0)[part] for x in (every, base, limits))
    pooled = float(np.mean(mean / limit)) / (rise * POOLED[channel.stage])
    groups = {e: float(np.mean(np.mean(square[e], axis=0)[part] / np.mean(allowed[e], axis=0)[part])) for e in square}
    worst = max(groups.values()) / (rise * (GROUPED_ENCODERS if channel.stage == "transmission" else GROUPED))
    return Gap(
        channel,
        max(pooled, worst),
        float(np.sqrt(np.mean(mean / low))),
        float(np.sqrt(np.mean(mean))),
        float(np.sqrt(np.mean(low))),
        groups,
    )


def localise(evidence: Evidence) -> list[Gap]:
    """Gaps of every channel recorded, most significant first."""
    channels = sorted({c for r in evidence.data.residuals for c in r})
    gaps = [g for c in channels if (g := gap_of(evidence, c)) is not None]
    return sorted(gaps, key=lambda g: -g.power)
