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
    for r in range(len(evidence.views)):
        found = evidence.data.residuals[r].get(channel)
        if found is None or not found.ok.any():
            continue
        power = np.mean((found.values / evidence.floors[r][channel]) ** 2, axis=1)
        masks = {name: mask for family in regime_masks(evidence, r, axis).values() for name, mask in family.items()}
        for name, mask in masks.items():
            if name in UNSAID:
                continue
            chosen = mask & found.ok
            if chosen.sum() >= 20:
                total.setdefault(name, []).append(float(power[chosen].mean()))
    return {name: float(np.mean(x)) for name, x in total.items()}


UNSAID = ("without load", "long after a reversal")
"""The ordinary regimes: a gap that is largest there is said to be everywhere."""
PHASES = ("first", "second", "third", "last")
"""Quarters of a motor revolution."""
WARM = 0.5
"""Range of temperatures [K] from which cool and warm samples are told apart."""


def regime_masks(evidence: Evidence, run: int, axis: int | None) -> dict[str, dict[str, np.ndarray]]:
    """Regimes of a run by family, (g,) masks; of one axis, or of the whole robot (None).

    The members of a family do not overlap and together are all samples.
    """
    view = evidence.views[run]
    if axis is None:
        speed, top = np.linalg.norm(view.velocity / _top(evidence), axis=1), 1.0
    else:
        speed, top = view.velocity[:, axis], float(_top(evidence)[axis])
    rest, fast = np.abs(speed) < 0.01 * top, np.abs(speed) >= 0.2 * top
    loaded = view.path.loaded
    families = {
        "speed": {"at rest": rest, "slow": ~rest & ~fast, "fast": fast},
        "load": {"under load": loaded, "without load": ~loaded},
        "excitation": {f"in {view.run.excitation}": np.ones(len(speed), dtype=bool)},
    }
    if view.run.temperature is not None and (warmth := _warmth(evidence))[1] > WARM:
        warm = view.warmth > warmth[0]
        families["temperature"] = {"warm": warm, "cool": ~warm}
    if axis is not None:
        after = _after_reversal(speed, top)
        families["direction"] = {"forward": speed > 0.01 * top, "backward": speed < -0.01 * top, "at rest": rest}
        families["reversal"] = {"just after a reversal": after, "long after a reversal": ~after}
        turn = view.position[:, axis] / evidence.robot.actuators[axis].lead
        quarter = np.floor(4.0 * (turn % 1.0)).astype(int)
        families["phase"] = {f"in the {n} quarter of a turn": quarter == k for k, n in enumerate(PHASES)}
    return families


def _top(evidence: Evidence) -> np.ndarray:
    return np.array([a.limits.velocity for a in evidence.robot.actuators])


def _warmth(evidence: Evidence) -> tuple[float, float]:
    """Middle and range of the temperatures of a case above 22 deg C [K]."""
    ends = [x for view in evidence.views for x in (float(view.warmth.min()), float(view.warmth.max()))]
    return 0.5 * (min(ends) + max(ends)), max(ends) - min(ends)


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
