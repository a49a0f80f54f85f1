"""What a gap looks like that no effect of the library explains."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit
from sher3_diagnosis.judge.evidence.free_law import ROWS, loss_left
from sher3_diagnosis.localise.regimes import regime
from sher3_diagnosis.quantify.closure import residual_after
from sher3_diagnosis.thresholds import LINE_SHARE, PERIOD_SHARE

SPECTRUM = 512
"""Samples of the discrete spectrum: a resolution of 0.2 Hz at 100 Hz."""
PERIODS = (*np.arange(0.25, 4.0, 0.25), *np.arange(4.0, 25.0))
"""Periods per motor revolution that are tried."""


def remainder(evidence: Evidence, channel: Channel, after: Fit) -> str:
    """Describe what is left of a gap under a fit: its regimes, its frequency, its period over a motor revolution, and
    the share that a free function of the inputs closes.
    """
    left = residual_after(evidence, after, channel)
    parts = [f"largest {regime(evidence, channel)}"]
    rate = evidence.views[next(iter(left))].rate
    frequency, share = (0.0, 0.0) if rate is None else dominant_frequency(left, rate)
    if share > LINE_SHARE:
        parts.append(f"{share:.0%} of its power near {frequency:.1f} Hz")
    period, fraction = position_period(evidence, channel, left)
    if fraction > PERIOD_SHARE:
        parts.append(f"repeats {period:.2f} times per motor revolution ({fraction:.0%})")
    parts.append(f"a free function of the inputs closes {ceiling(evidence, channel, left):.0%}")
    return "; ".join(parts)


def dominant_frequency(left: Mapping[int, Array], rate: float) -> tuple[float, float]:
    """Return the frequency of the strongest spectral line, Hz, and its share of the power, over all runs.

    Args:
        left: run -> (N, d); the first component is looked at.
        rate: samples per second.
    """
    total = np.zeros(SPECTRUM // 2 + 1)
    for x in left.values():
        y = x[:, 0] - x[:, 0].mean()
        total += np.abs(np.fft.rfft(y * np.hanning(len(y)), SPECTRUM)) ** 2
    if total.sum() == 0.0:
        return 0.0, 0.0
    line = int(np.argmax(total[1:])) + 1
    return line * rate / SPECTRUM, float(total[max(0, line - 2) : line + 3].sum() / total.sum())


def position_period(evidence: Evidence, channel: Channel, left: Mapping[int, Array]) -> tuple[float, float]:
    """Return the periods per motor revolution that explain most of what is left, and the share they explain.

    Both are 0 where the place is no axis or its lead is not known. `left`: (N, d) of each run, the channel's unit.
    """
    turns = []
    for r in left:
        motion = evidence.views[r].motion(channel.actuator)
        if motion is None or motion.lead is None:
            return 0.0, 0.0
        turns.append(2 * np.pi * motion.position[evidence.data.residuals[r][channel].ok] / motion.lead)
    best = (0.0, 0.0)
    y, turn = np.concatenate([x[:, 0] for x in left.values()]), np.concatenate(turns)
    for n in PERIODS:
        basis = np.column_stack([np.sin(n * turn), np.cos(n * turn), np.ones_like(turn)])
        coefficients = np.linalg.lstsq(basis, y, rcond=None)[0]
        share = 1.0 - np.mean((y - basis @ coefficients) ** 2) / np.mean(y**2)
        if share > best[1]:
            best = (float(n), float(share))
    return best


def ceiling(evidence: Evidence, channel: Channel, left: Mapping[int, Array]) -> float:
    """Return the held-out closure of a free function of the inputs, of the first component of what is left.

    It bounds what any static model of these inputs could close. `left`: (N, d) of each run, the channel's unit.
    """
    step = max(1, sum(map(len, left.values())) // ROWS)
    rows = [evidence.views[r].inputs(channel.actuator)[evidence.data.residuals[r][channel].ok][::step] for r in left]
    y = np.concatenate([x[::step, :1] / evidence.floors[r][channel][0] for r, x in left.items()])
    before = float(np.mean(y**2))
    (after,) = loss_left([np.concatenate(rows)], y, np.repeat(list(left), [len(x) for x in rows]))
    return float(np.clip((before - after) / max(before - 1.0, 1e-9), 0.0, 1.0))
