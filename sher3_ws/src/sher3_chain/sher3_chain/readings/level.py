"""An effort that says nothing for a stretch: flat at its largest reading, or exactly zero while the drive is off."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array, Mask
from sher3_machines.intake.mending.readings import longest_run

from sher3_chain.thresholds import LONGEST, PINNED

OFF_FOR = 0.02
"""Share of a record for which an effort must be exactly zero for its drive to be off: an effort that crosses zero, or
is read in coarse steps, is zero for some samples. Set by that argument."""

STEPS = 0.5
"""Share of the other samples that repeat the one before from which an effort goes in steps, and has no level by
itself."""


def at_a_level(effort: Array) -> Mask:
    """Return (n,) True where a reading lies at its largest or least value for a stretch: it or the drive is limited.

    Zero is no limit: a load without a sign, or one that a joint is let down under, is often exactly nothing.
    One that goes in steps everywhere, as a test with constant forces or few bits does, is at no limit; nor is one that
    only passes from one level to the other, be it in samples between the two, as on a clock that is no drive's.
    """
    zero = effort == 0.0
    out = np.zeros(len(effort), dtype=bool)
    for level in (float(effort.max()), float(effort.min())):
        at = effort == level
        if level and at.mean() >= PINNED and longest_run(at) >= LONGEST and not at.all():
            out |= at
    return np.zeros_like(out) if _in_steps(effort, ~out & ~zero) else out


def _in_steps(effort: Array, some: Mask) -> bool:
    """Return whether some samples (n,) of an effort repeat the one before, as what a drive is told by a test does."""
    repeats = np.diff(effort)[some[1:] & some[:-1]] == 0.0
    return longest_run(some) < LONGEST or float(np.mean(repeats)) > STEPS


def off(effort: Array) -> Mask:
    """Return (n,) True where a reading is exactly zero for a long stretch: the drive is off, and what it gives unknown.

    A record without any other reading is no drive that is off for a while; of one in steps zero is a step like others.
    """
    zero, out = effort == 0.0, np.zeros(len(effort), dtype=bool)
    if zero.all() or _in_steps(effort, ~zero):
        return out
    edges = np.flatnonzero(np.diff(np.concatenate([[0], zero.astype(int), [0]])))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        out[first:last] = last - first >= max(LONGEST, OFF_FOR * len(effort))
    return out


def off_note(what: str, at: Mask) -> str:
    """Return the sentence that names a drive which is off in some samples (n,)."""
    return f"{what} is exactly zero in {at.mean():.0%} of the samples: the drive is off; these samples are not judged"


def level_note(what: str, at: Mask) -> str:
    """Return the sentence that names a reading which is at a level in some samples (n,)."""
    return (
        f"{what} lies flat at its largest reading in {at.mean():.0%} of the samples: its reading or the drive is at a "
        "limit; these samples are not judged"
    )


def stop_note(joint: str, at: Mask) -> str:
    """Return the sentence that names a joint which a stop pushes back in some samples (n,)."""
    return (
        f"{joint}: lies beyond the range in which it is free for {at.mean():.1%} of the record, where a stop pushes it "
        "back: not judged there"
    )
