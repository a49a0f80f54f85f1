"""Whether a verdict of no gap has any power: the floor of a force balance, or of a tracking error, over its signal."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from sher3_diagnosis.channel import Array, Channel, Mask
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.finding import Finding
from sher3_diagnosis.thresholds import EATEN

BALANCE = "motor_mechanics"
"""Stage of a force balance and of a tracking error."""
Signal = Callable[[int, str, Mask], Array]
"""Run, site and samples that count -> signal (n,) of which the floor is a share, SI units."""


def eaten(finding: Finding, signal: Signal) -> dict[Channel, float]:
    """Return channel -> floor over signal of each balance without a gap whose floor hides a share worth a name."""
    evidence: Evidence = finding.evidence
    balances = [c for c in evidence.channels if c.stage == BALANCE and c not in finding.significant]
    shares = {c: hidden_share(evidence, c, signal) for c in balances}
    return {c: share for c, share in shares.items() if share > EATEN}


def hidden_share(evidence: Evidence, channel: Channel, signal: Signal) -> float:
    """Return the floor of a balance over its signal; infinite without a signal."""
    runs = [(r, x[channel].ok) for r, x in enumerate(evidence.data.residuals) if channel in x]
    floor = np.sqrt(np.mean([evidence.floors[r][channel][0] ** 2 for r, _ in runs]))
    rms = np.sqrt(np.mean(np.concatenate([signal(r, channel.actuator, ok) for r, ok in runs]) ** 2))
    return float(floor / rms) if rms > 0.0 else np.inf


def unjudgeable(finding: Finding, signal: Signal) -> dict[Channel, str]:
    """Return a sentence for each balance of a part, where the floor eats the signal of all of them; else nothing."""
    found = eaten(finding, signal)
    balances = [c for c in finding.evidence.channels if c.stage == BALANCE]
    if finding.significant or len(found) < len(balances):
        return {}
    return {c: f"cannot be judged: {power_note(c, share)}" for c, share in found.items()}


def power_note(channel: Channel, share: float) -> str:
    """Return in words why the absence of a cause cannot be shown, and which record would show it."""
    hidden = f"what nobody can foresee at {channel.actuator} is {share:.2g} of its signal, and a cause would hide in it"
    return f"{hidden}; a higher rate, larger or slower motion, or repeats of one motion would tell"
