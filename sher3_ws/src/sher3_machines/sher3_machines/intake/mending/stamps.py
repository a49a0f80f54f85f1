"""Stamps that repeat, come in a wrong order or in bunches, are rounded or start again, and periods that were missed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from sher3_diagnosis.channel import Array

from sher3_machines.errors import MachineError

ROUNDED = 0.2
"""Share of steps of zero from which stamps are rounded; fewer are samples that were written twice."""
EVEN, TICKING = 0.1, 0.9
"""Share by which the ticks of a clock may differ from the usual one, and the share of them that must not."""
FEWEST = 3
"""Stamps below which nothing can be said of them."""
MIXED_UP = 10.0
"""Periods by which a sample may come too late in a log; what comes later belongs to another record."""

BUNCHED, CLOSE = (0.5, 0.95), 0.1
"""Shares of the steps, between which samples come in bunches, that are shorter than this share of the mean step: twenty
samples in a row are a record of their own."""
ROUNDS = (1.0, 3.6, 6.0, 8.64)
"""First digits of what clocks count to: powers of ten, an hour, a minute, a day."""
CLEAR = 0.25
"""Periods by which a clock that starts again may be late by what it counts to."""


def even_stamps(stamps: Array, run: str) -> tuple[Array, NDArray[np.int64], str]:
    """Return stamps (m,) that increase, the (m,) samples they are of, and a note; empty where none is needed.

    Samples that come in a wrong order are sorted, those that were written twice left out, and rounded stamps put on the
    line through them. Stamps that run far backwards stay as they are.

    Raises:
        MachineError: nobody knows when the samples were taken: time stands still, or rounded stamps are no line.
    """
    if stamps.ndim != 1:
        raise MachineError(f"{run}: the time is no column of numbers", value=stamps.shape, remedy="correct `time`")
    kept = np.flatnonzero(np.isfinite(stamps))
    notes = [f"{len(stamps) - len(kept)} samples without a stamp are left out"] if len(kept) < len(stamps) else []
    steps = np.diff(stamps[kept])
    if len(steps) < FEWEST or not (steps > 0.0).any():
        raise MachineError(
            f"{run}: time does not increase",
            value=f"{len(kept)} stamps" + (f", {stamps[kept[0]]:g} to {stamps[kept[-1]]:g}" if len(kept) else ""),
            limit=f"{FEWEST} different ones",
            remedy="give stamps that grow (turn those that fall; the time of day needs float64, not float32), or the "
            "rate of the samples: `time: {rate: HZ}`",
        )
    usual = float(np.median(steps[steps > 0.0]))
    if (steps < 0.0).any() and steps.min() > -MIXED_UP * usual:
        kept = kept[np.argsort(stamps[kept], kind="stable")]
        notes.append(f"{int((steps < 0.0).sum())} samples came in a wrong order; sorted by their stamps")
        steps = np.diff(stamps[kept])
    found, repeated = stamps[kept], float(np.mean(steps == 0.0))
    if 0.0 < repeated < ROUNDED:
        first = np.concatenate([[True], steps != 0.0])
        found, kept = found[first], kept[first]
        notes.append(f"{int((~first).sum())} stamps are there twice; the first one is taken")
    elif repeated >= ROUNDED and (steps >= 0.0).all():
        tick, line = float(steps[steps > 0.0].min()), _line(found)
        ticks = np.flatnonzero(np.concatenate([[True], steps > 0.0]))
        off = float(np.abs(line - found).max())
        if off <= 2.0 * tick:
            found = line
            notes.append(f"stamps are rounded to {tick:.3g} s; samples are taken as even")
        elif np.mean(np.abs(np.diff(found[ticks]) / usual - 1.0) < EVEN) > TICKING:
            found, kept = found[ticks], kept[ticks]
            notes.append(f"several rows have one stamp: of each of its {len(ticks)} ticks the first row is taken")
        else:
            raise MachineError(
                f"{run}: {repeated:.0%} of the stamps repeat the one before",
                value=f"{off:.3g} s off an even clock",
                limit=f"{2.0 * tick:.3g} s",
                remedy="record finer stamps, or state the rate of the samples: `time: {rate: HZ}`",
            )
    elif _in_bunches(found):
        found = _line(found)
        notes.append("samples came in bunches: their stamps are those of their arrival; samples are taken as even")
    return found, kept, f"{run}: {', '.join(notes)}" if notes else ""


def counted_on(stamps: Array) -> tuple[Array, float]:
    """Return stamps (n,) of a clock that starts again as of one that goes on, and what it counts to; 0: it does not.

    It counts to a round number, such as the milliseconds of a second, or, in whole numbers, to a power of two, and
    comes to it within a period.
    """
    steps = np.diff(stamps)
    if not (steps > 0.0).any() or not (steps < 0.0).any():
        return stamps, 0.0
    usual = float(np.median(steps[steps > 0.0]))
    ends = usual - steps[steps < 0.0]
    digit = 10.0 ** np.floor(np.log10(ends[0]))
    round_ones = [digit * r * k for r in ROUNDS for k in (1.0, 10.0)]
    round_ones += [2.0 ** np.round(np.log2(ends[0]))] if (stamps == np.round(stamps)).all() else []
    end = float(min(round_ones, key=lambda x: abs(x - ends[0])))
    if np.abs(ends - end).max() > CLEAR * usual or not 0.0 <= stamps.min() <= stamps.max() < end:
        return stamps, 0.0
    return stamps + end * np.cumsum(np.concatenate([[0.0], steps < 0.0])), end


def missed_periods(stamps: Array) -> NDArray[np.int64]:
    """Return how many periods are missing at each place where a clock with stamps (m,) missed some."""
    missing = missing_at(stamps)
    return missing[missing > 0]


def missing_at(stamps: Array) -> NDArray[np.int64]:
    """Return how many periods are missing after each stamp of a clock (m,) but the last, (m - 1,).

    A stamp that is only late is followed by a short step; after a missed period the clock goes on late.
    """
    steps = np.diff(stamps)
    period = float(np.median(steps))
    two = np.concatenate([steps[:-1] + steps[1:], steps[-1:] + period])
    missing = np.minimum(np.round(steps / period), np.round(two / period - 1.0)).astype(np.int64) - 1
    return np.maximum(missing, 0)


def missing_note(missed: NDArray[np.int64], period: float, run: str) -> str:
    """Return what to say of periods (k,) that a clock with a period in s missed at each of k places."""
    longest = int(missed.max())
    return (
        f"{run}: the clock missed {int(missed.sum())} periods of {1e3 * period:.4g} ms at {len(missed)} places, "
        f"{longest} ({1e3 * longest * period:.4g} ms) at most; interpolated"
    )


def _in_bunches(stamps: Array) -> bool:
    """Return whether stamps (n,) are those of an arrival: several close together, no further off a line than waits."""
    steps = np.diff(stamps)
    close = float(np.mean(steps < CLOSE * steps.mean()))
    return BUNCHED[0] < close < BUNCHED[1] and float(np.abs(_line(stamps) - stamps).max()) <= float(steps.max())


def _line(stamps: Array) -> Array:
    """Return stamps (n,) on the line through them, by least squares."""
    row = np.arange(len(stamps)) - 0.5 * (len(stamps) - 1)
    return np.asarray(stamps.mean() + row * float(row @ stamps) / float(row @ row))
