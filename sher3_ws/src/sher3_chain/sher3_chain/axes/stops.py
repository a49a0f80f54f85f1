"""Stops of an axis that nobody stated: an end of its travel where it is held by more force than its drive ever gave."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array, Mask
from sher3_diagnosis.localise.readings import noise_of

from sher3_chain.joint.description import Axis
from sher3_chain.readings.signals import AxisSignals

DEPTH = 5e-3
"""Share of the travel that a stop gives way by at most: blows of other speeds end that near to one another."""
CLEAR = 5.0
"""Counts, or standard deviations of the encoder's noise, that the depth is at least."""
MOST = 99.0
"""Per cent of the other samples that tell the largest force of the drive: after a blow it bounces for some."""
HARDER = 3.0
"""What holds an axis at a stop over the largest force of its drive elsewhere. What friction, weight and springs hold it
with, the drive gives, too, where it moves on; the margin is for impacts that two samples see in part."""
BEFORE = 2
"""Samples before a blow over which its speed is taken."""
BLOWS = 2
"""Times an axis is held at the same place at least: once may be a hand, or a wrong reading."""


def with_stops(signals: Sequence[AxisSignals], axis: Axis) -> tuple[Axis, list[str]]:
    """Return an axis with the range between the stops that its records show, and a sentence on each.

    An axis whose range is stated keeps it; of one that nothing drives no force tells a stop.
    """
    if axis.range is not None or axis.free or not all(push_of(s, axis) is not None for s in signals):
        return axis, []
    high, low = stop_of(signals, axis, 1.0), stop_of(signals, axis, -1.0)
    if high is None and low is None:
        return axis, []
    ends = (-np.inf if low is None else -low, np.inf if high is None else high)
    unit = axis.unit_of_position
    where = ", ".join(f"{end:.4g} {unit}" for end in ends if np.isfinite(end))
    note = f"{axis.name}: stops found at {where}, where more holds it than its drive ever gives; `range` states them"
    return axis.model_copy(update={"range": ends}), [note]


def push_of(run: AxisSignals, axis: Axis) -> Array | None:
    """Return what drives an axis, (n,): the force, or how far a servo's reference is ahead."""
    if axis.servo:
        return None if run.reference is None else (run.reference - run.motor)[:, 0]
    return None if run.effort is None else run.effort[:, 0]


def stop_of(signals: Sequence[AxisSignals], axis: Axis, side: float) -> float | None:
    """Return where a stop begins at one end, times `side` (1 or -1), m or rad; None where there is none.

    What holds the axis is its push and, where its mass is known, what brakes it: v^2 / 2 over the distance to rest.
    """
    places = [side * s.motor[:, 0] for s in signals]
    end, start = max(float(x.max()) for x in places), min(float(x.min()) for x in places)
    fine = max(axis.encoder_resolution, *map(noise_of, places))
    depth = max(CLEAR * fine, DEPTH * (end - start))
    mass = axis.mass if isinstance(axis.mass, float) and not axis.servo else 0.0
    held, most = [], 0.0
    for x, s in zip(places, signals, strict=True):
        push, inside = push_of(s, axis), x > end - depth
        assert push is not None
        elsewhere = push[~inside & (x > start + depth)]
        most = max(most, float(np.percentile(np.abs(elsewhere), MOST)) if len(elsewhere) else 0.0)
        for first, last in visits(inside):
            speed = max(0.0, float(x[first - 1] - x[first - 1 - BEFORE]) / (BEFORE * s.period))
            braked = mass * speed**2 / (2.0 * (depth + speed * s.period))
            rest = first + 1 + int(np.argmax(x[first:last]))
            held.append(side * float(np.mean(push[first:rest])) + braked)
    return end - depth if sum(x > HARDER * most for x in held) >= BLOWS else None


def visits(inside: Mask) -> list[tuple[int, int]]:
    """Return first and behind the last of each stretch of True that begins after `BEFORE` samples."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]]))).reshape(-1, 2)
    return [(int(first), int(last)) for first, last in edges if first > BEFORE]
