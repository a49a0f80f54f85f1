"""Which sampling of the encoder a recorded command was made with: the sampling whose law leaves least, at any gains."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache, lru_cache
from typing import NamedTuple

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_effects.view import StatedLaw

from sher3_chain.axes.command.residual import LawView, floor_of, residual_of
from sher3_chain.axes.command.sampling import CENTRAL, FASTER, LAST, TWO, Pace, Sampling, behind, stated_law
from sher3_chain.joint.description import Axis
from sher3_chain.readings.signals import AxisSignals

LAGS = (0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 8.0, 12.0)
"""Low-passes behind a speed that are tried, in periods."""
PLAIN = 0.3
"""Largest noise that a low-pass may leave, as a share of a plain sampling's: it smooths, and its corner is fitted."""
ALIKE = 1.2
"""Noise over the least noise up to which two samplings count as equal: medians of thousands of samples scatter by some
per cent."""
NOTHING_LEFT = 2.0
"""Power over the floor up to which a plain sampling leaves no gap: no other sampling is then tried."""
FINER = 9
"""Halvings of the step between two of them."""
SHIFTS = (0, 1, 2, 3, 4, 6, 8, 12, 16, 24)
"""Samples by which a command may lag its reading. A lag within one period is never stated; more is a delay."""


def best_sampling(signals: Sequence[AxisSignals], axis: Axis) -> Sampling:
    """Return the sampling whose law leaves least of the command's steps; of equal ones, least of the command itself.

    A plain sampling comes first where the stated law, its reference late or a gain wrong, leaves hardly anything. The
    steps would mislead there: a controller that knows its speed from elsewhere shows no encoder counts in them, and a
    log that is slower than its controller shows counts that the controller did not read.

    Args:
        signals: of one axis, a record each.
        axis: as described; its command law has a position gain.
    """

    @lru_cache(maxsize=1)  # all shifts of one pace are tried in turn
    def read(pace: Pace) -> list[StatedLaw]:
        return [stated_law(s, axis, Sampling(pace, 0)) for s in signals]

    @cache
    def left(sampling: Sampling) -> Array:
        laws = read(sampling.pace)
        return np.sum(
            [law_residual(s, behind(x.parts, sampling.shift)) for s, x in zip(signals, laws, strict=True)], axis=0
        )

    def noise(sampling: Sampling) -> float:
        return float(left(sampling)[1])

    def least(samplings: Sequence[Sampling]) -> Sampling:
        quietest = min(noise(s) for s in samplings)
        return min((s for s in samplings if noise(s) <= ALIKE * quietest), key=lambda s: float(left(s)[0]))

    if not axis.command_law.velocity_gain:
        return _within(least([Sampling(LAST, shift) for shift in SHIFTS]))
    tried = [Sampling(pace, 0) for pace in (LAST, TWO, CENTRAL, *FASTER)]
    found = {sampling: excess(signals, axis, sampling) for sampling in tried}
    plainest = _least_of(found)
    if min(found[plainest].late, found[plainest].gained) <= NOTHING_LEFT:
        return plainest
    plain = least([Sampling(pace, shift) for pace in (LAST, TWO, CENTRAL) for shift in SHIFTS])
    best = least([Sampling(pace, shift) for pace in (Pace(1.0, lag) for lag in LAGS) for shift in SHIFTS])
    step = LAGS[1] / LAGS[0]
    for _ in range(FINER):
        step = float(np.sqrt(step))
        near = [Pace(1.0, best.pace.lag * f) for f in (1.0, step, 1.0 / step)]
        best = least([Sampling(pace, shift) for pace in near for shift in SHIFTS])
    quiet = _within(best if noise(best) < PLAIN * noise(plain) else plain)
    found[quiet] = excess(signals, axis, quiet)
    stated = _least_of(found)
    better = any(a < PLAIN * b for a, b in zip(found[stated], found[quiet], strict=True))
    return stated if better else quiet


def _least_of(found: Mapping[Sampling, Excess]) -> Sampling:
    """Return the sampling that leaves least of a law with free gains, since nothing else changes what that leaves.

    Of equals the one under which the stated law reaches its floor best, or else a late law, or one with one gain wrong.
    Above the floor these say how far the law is off, and nothing of the sampling.
    """
    least = min(x.freed for x in found.values())
    equal = [sampling for sampling, x in found.items() if x.freed <= ALIKE * least]
    for law in (lambda x: x.stated, lambda x: x.late, lambda x: x.gained):
        best = min(equal, key=lambda sampling: law(found[sampling]))
        if law(found[best]) <= 1.0:
            return best
    return min(equal, key=lambda sampling: found[sampling].freed)


def _within(sampling: Sampling) -> Sampling:
    """Return the sampling with its lag where that is one sample at most: a longer lag is a delay."""
    return sampling if sampling.shift <= 1 else sampling._replace(shift=0)


class Excess(NamedTuple):
    """Power of command less law over its floor, a mean over the records.

    Attributes:
        stated: of the law as it is stated.
        late: of the law as it is stated for a reference that may be late.
        gained: of the law with one gain of its own, for all of it or for one part.
        freed: of the law with free gains of its parts as well: neither gains nor a late reference are matters of the
            sampling.
    """

    stated: float
    late: float
    gained: float
    freed: float


def excess(signals: Sequence[AxisSignals], axis: Axis, sampling: Sampling) -> Excess:
    """Return the power of command less law over its floor under a sampling, a mean over the records."""
    powers = []
    for run in signals:
        view = LawView(run, axis, sampling)
        left = residual_of(view)
        if left.ok.any():
            late, y = _lateness(run), left.values[left.ok, 0]
            parts = view.stated.parts
            free = [late, np.column_stack([parts, late]), parts.sum(axis=1)[:, None], *(x[:, None] for x in parts.T)]
            rest = [y, *(y - x @ np.linalg.lstsq(x, y, rcond=None)[0] for x in (run.to_grid(x)[left.ok] for x in free))]
            stated, with_late, freed, *one = np.mean((np.array(rest) / floor_of(view, left)) ** 2, axis=1)
            powers.append((stated, with_late, min(one), freed))
    return Excess(*np.mean(powers, axis=0).tolist()) if powers else Excess(0.0, 0.0, 0.0, 0.0)


def backwards(signals: Sequence[AxisSignals], axis: Axis, sampling: Sampling) -> bool:
    """Return whether the commands go against their law over the whole records, an integral beside it left free.

    A sign is a matter of the fit: at the rate of the samples the counts of an encoder, which come back at the next
    sample, outweigh what a law answers to them a period late. The law and its parts, each with a gain of its own, must
    both be turned: where the parts nearly cancel, one wrong gain turns their sum about; where a command is cut off, a
    part.
    """
    shares = []
    for run in signals:
        if run.command is not None:
            law, command = stated_law(run, axis, sampling), run.command[:, 0]
            whole, slow = law.command, _slow(law.error)
            each = [_solved(np.column_stack([x, *slow]), command)[:k].sum() for x, k in ((whole, 1), (law.parts, 3))]
            shares.append(each)
    return bool(shares) and bool(np.all(np.sum(shares, axis=0) < 0.0))


def _slow(error: Array) -> tuple[Array, Array]:
    """Return what a controller may add slowly: a constant, and an integral of its error, (n,) each."""
    return np.ones_like(error), np.cumsum(error)


def _lateness(run: AxisSignals) -> Array:
    """Return what a delay of the reference changes, but for its size: three terms of its series, (n, 3).

    20 ms of a motion at 5 Hz are a phase of 0.63: the third term is 4 % of the reference, the fourth 0.7 %.
    """
    assert run.reference is not None
    speed = np.gradient(run.reference[:, 0])
    bend = np.gradient(speed)
    return np.column_stack([speed, bend, np.gradient(bend)])


def law_residual(run: AxisSignals, parts: Array) -> Array:
    """Return what the parts (n, 3) of a law, each with a gain of its own, leave of the command and its steps; medians.

    Steps are second differences: the counts of the encoder stand out in them, which the right sampling has as well,
    and what else a controller may do, as a dead zone, is slow beside them. The gains are fitted to the command itself:
    in steps a sampling that reads the counts a period late is bettered by a gain of zero.
    """
    assert run.command is not None
    command = run.command[:, 0]
    free = np.abs(command) < np.abs(command).max()
    free = free if free[2:].any() else np.ones_like(free)
    x = np.column_stack([parts, np.ones_like(command)])
    size = np.linalg.norm(x[free], axis=0)
    left = command - x / np.where(size > 0.0, size, 1.0) @ _solved(x[free], command[free])
    return np.array([np.median(np.abs(left[free])), np.median(np.abs(np.diff(left, 2)[free[2:]]))])


def _solved(x: Array, y: Array) -> Array:
    """Return the coefficients of y (n,) in columns (n, p), which are brought to one size first."""
    size = np.linalg.norm(x, axis=0)
    x = x / np.where(size > 0.0, size, 1.0)  # of one size, the normal equations are exact enough
    return np.asarray(np.linalg.lstsq(x.T @ x, x.T @ y, rcond=None)[0])
