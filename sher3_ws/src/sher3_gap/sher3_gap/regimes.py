"""In which regime a gap lives: where its power over the floor is largest."""

from __future__ import annotations

import numpy as np
from sher3_description import ACTUATORS

from sher3_gap.channels import Channel
from sher3_gap.evidence import Evidence


def regime_powers(evidence: Evidence, channel: Channel) -> dict[str, float]:
    """Mean power over floor of a channel per regime.

    Motion, direction, time since reversal, speed, load, excitation.
    """
    axis = ACTUATORS.index(channel.actuator) if channel.actuator in ACTUATORS else None
    total: dict[str, list[float]] = {}
    for r, view in enumerate(evidence.views):
        found = evidence.data.residuals[r].get(channel)
        if found is None or not found.ok.any():
            continue
        power = np.mean((found.values / evidence.floors[r][channel]) ** 2, axis=1)
        speed = view.velocity[:, axis] if axis is not None else np.linalg.norm(view.velocity / _top(evidence), axis=1)
        top = evidence.robot.actuators[axis].limits.velocity if axis is not None else 1.0
        masks = {
            "at rest": np.abs(speed) < 0.01 * top,
            "slow": (np.abs(speed) >= 0.01 * top) & (np.abs(speed) < 0.2 * top),
            "fast": np.abs(speed) >= 0.2 * top,
            "under load": view.path.loaded,
            f"in {view.run.excitation}": np.ones(len(power), dtype=bool),
        }
        if axis is not None:
            masks["forward"], masks["backward"] = speed > 0.01 * top, speed < -0.01 * top
            masks["just after a reversal"] = _after_reversal(speed, top)
        for name, mask in masks.items():
            chosen = mask & found.ok
            if chosen.sum() >= 20:
                total.setdefault(name, []).append(float(power[chosen].mean()))
    return {name: float(np.mean(x)) for name, x in total.items()}


def _top(evidence: Evidence) -> np.ndarray:
    return np.array([a.limits.velocity for a in evidence.robot.actuators])


def _after_reversal(speed: np.ndarray, top: float, samples: int = 10) -> np.ndarray:
    direction = np.where(np.abs(speed) > 0.01 * top, np.sign(speed), 0.0)
    out = np.zeros(len(speed), dtype=bool)
    last = 0.0
    for k, d in enumerate(direction):
        if d and last and d != last:
            out[k : k + samples] = True
        last = d or last
    return out


def regime(evidence: Evidence, channel: Channel) -> str:
    """Name of the regimes in which the gap is largest, in words."""
    powers = regime_powers(evidence, channel)
    if not powers:
        return "everywhere"
    mean = float(np.mean(list(powers.values())))
    high = sorted((n for n, p in powers.items() if p > 1.3 * mean and p > 1.5), key=lambda n: -powers[n])
    return ", ".join(high[:3]) if high else "everywhere"
