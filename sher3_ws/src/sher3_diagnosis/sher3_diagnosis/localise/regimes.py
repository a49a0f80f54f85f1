"""In which regime a gap lives: where its power over the floor is largest."""

from __future__ import annotations

import numpy as np

from sher3_diagnosis.channel import Array, Channel, Mask
from sher3_diagnosis.evidence import Evidence, Motion
from sher3_diagnosis.thresholds import AT_REST, FAST, JUST_AFTER, REGIME_GAP, REGIME_SAMPLES, STANDS_OUT, WARM

UNSAID = ("without load", "long after a reversal")
"""The ordinary regimes: a gap that is largest there is said to be everywhere."""
PHASES = ("first", "second", "third", "last")
"""Quarters of a motor revolution."""
NAMED = 3
"""Regimes named of a gap at most."""

Families = dict[str, dict[str, Mask]]
"""Family of regimes -> regime -> (g,) samples in it. The members of a family do not overlap and together are all."""


def regime(evidence: Evidence, channel: Channel) -> str:
    """Return the regimes in which the gap is largest, in words."""
    powers = regime_powers(evidence, channel)
    if not powers:
        return "everywhere"
    mean = float(np.mean(list(powers.values())))
    high = [name for name, power in powers.items() if power > STANDS_OUT * mean and power > REGIME_GAP]
    return ", ".join(sorted(high, key=lambda n: -powers[n])[:NAMED]) if high else "everywhere"


def regime_powers(evidence: Evidence, channel: Channel) -> dict[str, float]:
    """Return the mean power over floor of a channel per regime: motion, direction, reversal, load, excitation, ..."""
    total: dict[str, list[float]] = {}
    unsaid = {*UNSAID, *(f"in {x}" for x in evidence.excitations if len(set(evidence.excitations)) == 1)}
    for r in range(len(evidence.views)):
        found = evidence.data.residuals[r].get(channel)
        if found is None or not found.ok.any():
            continue
        power = np.mean((found.values / evidence.floors[r][channel]) ** 2, axis=1)
        families = regime_masks(evidence, r, channel.actuator)
        for name, mask in {n: m for family in families.values() for n, m in family.items()}.items():
            chosen = mask & found.ok
            if name not in unsaid and chosen.sum() >= REGIME_SAMPLES:
                total.setdefault(name, []).append(float(power[chosen].mean()))
    return {name: float(np.mean(x)) for name, x in total.items()}


def regime_masks(evidence: Evidence, run: int, actuator: str) -> Families:
    """Return the regimes of a run by family: of one axis, or of the whole machine where `actuator` is no axis."""
    view = evidence.views[run]
    motion = view.motion(actuator)
    speed, top = (view.speed_share, 1.0) if motion is None else (motion.velocity, motion.top)
    rest, fast = np.abs(speed) < AT_REST * top, np.abs(speed) >= FAST * top
    families: Families = {
        "speed": {"at rest": rest, "slow": ~rest & ~fast, "fast": fast},
        "load": {"under load": view.loaded, "without load": ~view.loaded},
        "excitation": {f"in {view.excitation}": np.ones(len(speed), dtype=bool)},
    }
    middle, span = _warmth(evidence)
    if view.temperature_known and span > WARM:
        families["temperature"] = {"warm": view.warmth > middle, "cool": view.warmth <= middle}
    return families if motion is None else {**families, **_axis_regimes(motion)}


def _axis_regimes(motion: Motion) -> Families:
    """Return the regimes that only an axis has: direction, time since a reversal, phase of the motor's turn."""
    speed, limit = motion.velocity, AT_REST * motion.top
    after = _after_reversal(speed, limit)
    families: Families = {
        "direction": {"forward": speed > limit, "backward": speed < -limit, "at rest": np.abs(speed) < limit},
        "reversal": {"just after a reversal": after, "long after a reversal": ~after},
    }
    if motion.lead is not None:
        quarter = np.floor(4.0 * ((motion.position / motion.lead) % 1.0)).astype(int)
        families["phase"] = {f"in the {name} quarter of a turn": quarter == k for k, name in enumerate(PHASES)}
    return families


def _warmth(evidence: Evidence) -> tuple[float, float]:
    """Return the middle and the range of the temperatures of all runs above the reference, K."""
    ends = [x for view in evidence.views for x in (float(view.warmth.min()), float(view.warmth.max()))]
    return 0.5 * (min(ends) + max(ends)), max(ends) - min(ends)


def _after_reversal(speed: Array, limit: float) -> Mask:
    moving = np.flatnonzero(np.abs(speed) > limit)
    out = np.zeros(len(speed), dtype=bool)
    for k in moving[1:][np.diff(np.sign(speed[moving])) != 0.0]:
        out[k : k + JUST_AFTER] = True
    return out
