"""What a gap looks like that no effect of the library explains."""

from __future__ import annotations

import numpy as np
from sher3_description import ACTUATORS

from sher3_gap.channels import Array, Channel
from sher3_gap.evidence import Evidence
from sher3_gap.fitting import Fit
from sher3_gap.quantify import residual_after
from sher3_gap.regimes import regime
from sher3_gap.signals import DECIMATED_RATE


def signature(evidence: Evidence, channel: Channel, after: Fit) -> str:
    """Describe what is left: regimes, frequency, position period, and the share that any smooth function of the inputs
    closes.
    """
    left = residual_after(evidence, after, channel)
    parts = [f"largest {regime(evidence, channel)}"]
    frequency, share = dominant_frequency(list(left.values()))
    if share > 0.15:
        parts.append(f"{share:.0%} of its power near {frequency:.1f} Hz")
    if channel.actuator in ACTUATORS:
        period, fraction = position_period(evidence, channel, left)
        if fraction > 0.2:
            parts.append(f"repeats {period:.2f} times per motor revolution ({fraction:.0%})")
    parts.append(f"a free function of the inputs closes {ceiling(evidence, channel, left):.0%}")
    return "; ".join(parts)


def dominant_frequency(series: list[Array]) -> tuple[float, float]:
    """Frequency of the strongest spectral line (Hz) and its share of the power, over all runs."""
    total: Array | None = None
    for x in series:
        y = x[:, 0] - x[:, 0].mean()
        n = 512
        spectrum = np.abs(np.fft.rfft(y * np.hanning(len(y)), n)) ** 2
        total = spectrum if total is None else total + spectrum
    if total is None or total.sum() == 0.0:
        return 0.0, 0.0
    k = int(np.argmax(total[1:])) + 1
    return k * DECIMATED_RATE / 512, float(total[max(0, k - 2) : k + 3].sum() / total.sum())


def position_period(evidence: Evidence, channel: Channel, left: dict[int, Array]) -> tuple[float, float]:
    """Periods per motor revolution that explain most of the residual, and the share they explain."""
    axis = ACTUATORS.index(channel.actuator)
    lead = evidence.robot.actuators[axis].lead
    best = (0.0, 0.0)
    y = np.concatenate([x[:, 0] for x in left.values()])
    turn = np.concatenate(
        [2 * np.pi * evidence.views[r].position[evidence.data.residuals[r][channel].ok, axis] / lead for r in left]
    )
    for n in np.concatenate([np.arange(0.25, 4.0, 0.25), np.arange(4.0, 25.0)]):
        basis = np.column_stack([np.sin(n * turn), np.cos(n * turn), np.ones_like(turn)])
        coefficients = np.linalg.lstsq(basis, y, rcond=None)[0]
        share = 1.0 - np.mean((y - basis @ coefficients) ** 2) / np.mean(y**2)
        if share > best[1]:
            best = (float(n), float(share))
    return best


def ceiling(evidence: Evidence, channel: Channel, left: dict[int, Array]) -> float:
    """Held-out closure of a free function of position, velocity, direction and effort: binned regression trees,
    boosted.

    An upper bound on what any static model of the stage's inputs could close.
    """
    rows, targets, runs = [], [], []
    for r, x in left.items():
        view, ok = evidence.views[r], evidence.data.residuals[r][channel].ok
        floor = evidence.floors[r][channel]
        axis = ACTUATORS.index(channel.actuator) if channel.actuator in ACTUATORS else 0
        load = view.path.contact_force[ok, axis]
        features = [
            view.position[ok, axis],
            view.velocity[ok, axis],
            np.sign(np.round(view.velocity[ok, axis], 5)),
            load,
        ]
        rows.append(np.column_stack(features))
        targets.append(x[:, 0] / floor[0])
        runs.append(np.full(len(x), r))
    inputs, y, group = np.concatenate(rows), np.concatenate(targets), np.concatenate(runs)
    predicted = np.zeros_like(y)
    for r in np.unique(group):
        train, test = group != r, group == r
        if train.sum() > 100:
            predicted[test] = _boosted(inputs[train], y[train], inputs[test])
    before, after = float(np.mean(y**2)), float(np.mean((y - predicted) ** 2))
    return float(np.clip((before - after) / max(before - 1.0, 1e-9), 0.0, 1.0))


def _boosted(x: Array, y: Array, new: Array, rounds: int = 60, bins: int = 24, rate: float = 0.3) -> Array:
    """Additive regression on pairs of binned inputs: small, fast and without assumptions on shape."""
    edges = [np.unique(np.quantile(c, np.linspace(0, 1, bins + 1)[1:-1])) for c in x.T]
    codes = [np.searchsorted(e, c) for e, c in zip(edges, x.T, strict=True)]
    fresh = [np.searchsorted(e, c) for e, c in zip(edges, new.T, strict=True)]
    out, left = np.zeros(len(new)), y.copy()
    pairs = [(i, j) for i in range(x.shape[1]) for j in range(i, x.shape[1])]
    for k in range(rounds):
        i, j = pairs[k % len(pairs)]
        cell, other = codes[i] * (bins + 1) + codes[j], fresh[i] * (bins + 1) + fresh[j]
        size = (bins + 1) ** 2
        count = np.bincount(cell, minlength=size)
        mean = np.bincount(cell, left, minlength=size) / (count + 5.0)
        left -= rate * mean[cell]
        out += rate * mean[other]
    return out
