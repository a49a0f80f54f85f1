"""Where the gap is: gap over floor of every channel, over all runs and excitation by excitation."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.thresholds import FLOOR_SCATTER, GROUPED, GROUPED_ENCODERS, POOLED, ZERO_COUNTS

PARTS = {6: (slice(0, 3), slice(3, 6)), 3: (slice(0, 3),), 1: (slice(0, 1),)}
"""Number of components -> those that are judged together: position and rotation, force and torque, position alone."""

Powers = Mapping[str, Sequence[Array]]
"""Excitation -> mean squares of its runs, (d,) each."""


@dataclass(frozen=True)
class Gap:
    """Gap and floor of one channel.

    Attributes:
        power: mean square over its floor, pooled over all runs and of the worst excitation, each over its threshold;
            the larger of the two. Above 1 there is a gap.
        gap, floor: rms over all runs of one component, SI units: of the worse part (position or rotation, force or
            torque) the one with the largest ratio.
        groups: excitation -> power of that part over its floor.
        component: index of that component.
    """

    channel: Channel
    power: float
    gap: float
    floor: float
    groups: Mapping[str, float]
    component: int = 0

    @property
    def ratio(self) -> float:
        """Gap over floor of the component."""
        return self.gap / max(self.floor, np.finfo(float).tiny)

    @property
    def significant(self) -> bool:
        """Whether the gap exceeds its floor."""
        return self.power > 1.0


def localise(evidence: Evidence, residuals: Mapping[Channel, Mapping[int, Array]] | None = None) -> list[Gap]:
    """Return the gap of every channel recorded, most significant first.

    Args:
        evidence: to be judged.
        residuals: (n, d) per channel and run, in place of the nominal residual where other terms than causes act on it.
    """
    residuals = residuals or {}
    gaps = [g for c in evidence.channels if (g := gap_of(evidence, c, residuals.get(c))) is not None]
    return sorted(gaps, key=lambda g: -g.power)


def gap_of(evidence: Evidence, channel: Channel, residual: Mapping[int, Array] | None = None) -> Gap | None:
    """Return the gap of a channel; None where it was not recorded.

    Args:
        evidence: of the part the channel belongs to.
        channel: to judge.
        residual: run -> (N, d) samples that count, relieved of their free mean; default the nominal residual.
    """
    left: dict[int, Array] = {}
    square: dict[str, list[Array]] = defaultdict(list)
    floor: dict[str, list[Array]] = defaultdict(list)
    for r, excitation in enumerate(evidence.excitations):
        found = evidence.data.residuals[r].get(channel)
        if found is None or not found.ok.any():
            continue
        left[r] = found.relieved(found.values[found.ok]) if residual is None else residual[r]
        base = evidence.floors[r][channel] ** 2
        square[excitation].append(np.mean(left[r] ** 2, axis=0))
        floor[excitation].append(base)
    if not left:
        return None
    rise = 1.0 + FLOOR_SCATTER / max(evidence.repeats, 1)
    parts = [_part(channel, p, square, floor, rise) for p in PARTS[len(base)]]
    return _with_zeros(evidence, channel, left, max(parts, key=lambda g: g.power))


def _part(channel: Channel, part: slice, square: Powers, floor: Powers, rise: float) -> Gap:
    """Judge the components that belong together."""
    mean, low = (np.mean(_all(x), axis=0)[part] for x in (square, floor))
    groups = {e: float(np.mean(np.mean(square[e], axis=0)[part] / np.mean(floor[e], axis=0)[part])) for e in square}
    grouped = GROUPED_ENCODERS if channel.stage == "transmission" else GROUPED
    pooled = float(np.mean(mean / low)) / (rise * POOLED[channel.stage])
    worst = max(groups.values()) / (rise * grouped)
    largest = int(np.argmax(mean / low))
    return Gap(
        channel,
        power=max(pooled, worst),
        gap=float(np.sqrt(mean[largest])),
        floor=float(np.sqrt(low[largest])),
        groups=groups,
        component=part.start + largest,
    )


def component_rms(residual: Mapping[int, Array], component: int) -> float:
    """Return the rms over all runs of one component of a residual, run -> (N, d), SI units."""
    return float(np.sqrt(np.mean([np.mean(x[:, component] ** 2) for x in residual.values()])))


def _all(powers: Powers) -> list[Array]:
    return [x for runs in powers.values() for x in runs]


def _with_zeros(evidence: Evidence, channel: Channel, left: Mapping[int, Array], best: Gap) -> Gap:
    """Judge the runs' mean encoder difference as well, against what their zeros may differ by."""
    residuals = {r: evidence.data.residuals[r][channel] for r in left}
    if not all(x.partly_free for x in residuals.values()):
        return best
    means = [float(residuals[r].restored(values).mean()) for r, values in left.items()]
    mean, limit = float(np.sqrt(np.mean(np.square(means)))), ZERO_COUNTS * evidence.count(channel)
    if (mean / limit) ** 2 <= best.power:
        return best
    return replace(best, power=(mean / limit) ** 2, gap=mean, floor=limit / 3.0)
