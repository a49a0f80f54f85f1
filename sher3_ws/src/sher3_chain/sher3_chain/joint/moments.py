"""When samples were taken: at their stamps, or evenly, where the stamps are those of a busy logger.

A drive samples by a timer; a program stamps a sample when it gets round to it. The motion shows which of the two a
record has: the path is smooth over the times at which it was really sampled.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_machines.intake.mending.stamps import missing_at

JITTER = 0.01
"""Share of the period by which stamps may be off before the record is resampled."""
CLEARLY = 0.7
"""Roughness over even times, as a share of that over the stamps, below which the samples were taken evenly. Where the
motion shows nothing the share is 1."""
FEWEST = 20
"""Samples that a path must have for its roughness to be compared."""

Stamped = tuple[Array | None, Array]
"""Stamps in s, where there are any, and the samples."""


def timed(raw: Mapping[str, dict[str, Stamped]], run: str) -> list[str]:
    """Put signals on an even clock where their positions say that they were sampled so; return a note for each clock.

    Args:
        raw: joint -> signal -> stamps and samples; changed in place. Signals that share stamps share their moments.
        run: of the record.
    """
    clocks: dict[bytes, list[Stamped]] = {}
    for found in raw.values():
        stamps, _ = found["position"]
        if stamps is not None and len(stamps) >= FEWEST:
            clocks.setdefault(stamps.tobytes(), []).append(found["position"])
    notes = []
    for positions in clocks.values():
        stamps, even = positions[0][0], evenly(positions)
        if stamps is None or even is None:
            continue
        off = float(np.abs(stamps - even).max())
        notes.append(
            f"{run}: stamps are up to {1e3 * off:.3g} ms off the even clock by which it was sampled; put on it"
        )
        for found in raw.values():
            for which, (own, x) in found.items():
                if own is not None and np.isin(own, stamps).all():
                    found[which] = np.interp(own, stamps, even), x
    return notes


def evenly(positions: list[Stamped]) -> Array | None:
    """Return the even stamps (n,) of positions that share their stamps; None where those are right, or no even clock's.

    Periods that the clock missed stay missed. Stamps that are a period and more off an even clock are of another one.
    """
    stamps = positions[0][0]
    assert stamps is not None
    row = np.arange(len(stamps), dtype=float)
    missed = np.concatenate([[0.0], np.cumsum(missing_at(stamps), dtype=float)])
    lines = [on_a_line(row + k, stamps) for k in (np.zeros_like(row), missed)]
    clocks = [even for even, off in lines if JITTER < off < 1.0]
    if not clocks:
        return None
    before = np.array([roughness(stamps, x) for _, x in positions])
    after = [np.array([roughness(even, x) for _, x in positions]) for even in clocks]
    best = int(np.argmin([np.sum(rough / np.where(before > 0.0, before, 1.0)) for rough in after]))
    return clocks[best] if np.mean(after[best] < CLEARLY * before) > 0.5 else None


def on_a_line(turn: Array, stamps: Array) -> tuple[Array, float]:
    """Return the line through the stamps of turns (n,) of a clock, and by how many periods they are off it at most."""
    slope, start = np.polyfit(turn - turn.mean(), stamps, 1)
    line = start + slope * (turn - turn.mean())
    return line, float(np.abs(stamps - line).max() / slope)


def roughness(t: Array, x: Array) -> float:
    """Return by how much samples (n,) at t (n,) are off the cubic through two neighbours on either side, a mean."""
    near = (-2, -1, 1, 2)
    here, times = t[2:-2], {k: t[2 + k : len(t) - 2 + k] for k in near}
    foreseen = np.zeros_like(here)
    for k in near:  # Lagrange's form
        share = np.prod([(here - times[j]) / (times[k] - times[j]) for j in near if j != k], axis=0)
        foreseen += share * x[2 + k : len(t) - 2 + k]
    return float(np.mean(np.abs(x[2:-2] - foreseen)))
