"""Hysteresis operators that several effects share, compiled."""

from __future__ import annotations

import math

import numpy as np
from sher3_common.compiled import compiled
from sher3_common.laws import swing_map
from sher3_diagnosis.channel import Array

NEAR_LIMIT = 0.95
"""Share of a force limit from which a reported force may be clamped by it: the noise of the report is a few percent."""
AT_ONCE = 1e-12
"""Displacement, m or rad, over which a force turns at once: less than any encoder shows."""


@compiled
def dahl(x: Array, displacement: float) -> Array:
    """Dahl's solid friction state of a path x (n,) (Dahl 1968).

    Dz/dx = (1 - z sgn dx) / displacement, z(0) = 0 -> (n,) in -1..1.
    """
    out = np.zeros(len(x))
    z = 0.0
    for k in range(1, len(x)):
        step = x[k] - x[k - 1]
        if step > 0.0:
            z = 1.0 - (1.0 - z) * math.exp(-step / displacement)
        elif step < 0.0:
            z = -1.0 + (1.0 + z) * math.exp(step / displacement)
        out[k] = z
    return out


@compiled
def dahl_turned(x: Array, v: Array, displacement: float, period: float) -> Array:
    """Dahl's state as `dahl`, of a path x (n,) with velocities v (n,) that turns round between its samples.

    Where the velocity changes its sign from one sample to the next, the path goes on to where it is zero and comes back
    from there. By the samples alone the state would turn half a period late on average. Over a displacement of 0 it
    turns at once.
    """
    out = np.zeros(len(x))
    z, reach = 0.0, max(displacement, AT_ONCE)
    for k in range(1, len(x)):
        on = 0.0
        if v[k - 1] * v[k] < 0.0:
            on = 0.5 * period * v[k - 1] * v[k - 1] / (v[k - 1] - v[k])
        for step in (on, x[k] - x[k - 1] - on):
            if step > 0.0:
                z = 1.0 - (1.0 - z) * math.exp(-step / reach)
            elif step < 0.0:
                z = -1.0 + (1.0 + z) * math.exp(step / reach)
        out[k] = z
    return out


@compiled
def sheath(tension: Array, wrap: float, pieces: int = 16) -> Array:
    """Logarithm of the tension in each piece of a sheath (n, pieces), from that at its beginning, (n,).

    A piece holds its tension until its neighbour's is larger or smaller by exp(wrap / pieces): there it slides
    (capstan, Euler 1769). That is a chain of plays in the logarithm: after a reversal the sliding part grows from the
    beginning on.
    """
    out = np.empty((len(tension), pieces))
    step = wrap / pieces
    for k in range(len(tension)):
        before = tension[k]
        for i in range(pieces):
            held = out[k - 1, i] if k else tension[0]
            before = min(max(held, before - step), before + step)
            out[k, i] = before
    return out


@compiled
def released_play(
    x: Array, drive: Array, rest: Array, release: float, width: float, damping: float, period: float, start: float
) -> Array:
    """Follower behind a gap of `width` whose friction gives way by up to `release` before it slides, minus x, (n,).

    Between the flanks it moves under the load `drive` (n,) against a viscous `damping` (inf: it stays put): a load that
    reverses takes it across the gap without the motor moving. `start` in -1..1 is where in the gap it begins. After a
    reversal it goes back with its flank to where its friction and the load on it are in balance, and only there
    the flank leaves it: `rest` (n,) in -release..release, from where the friction holds nothing (Dahl's bristle, linear
    up to the level: Prandtl 1928).
    """
    out = np.empty(len(x))
    half = 0.5 * width
    held = x[0] + start * half
    for k in range(len(x)):
        held += period * drive[k] / damping
        y = min(max(held + rest[k], x[k] - half), x[k] + half)
        held = min(max(held, y - release), y + release)
        out[k] = y - x[k]
    return out


@compiled
def play(x: Array, width: float, start: float = 0.0) -> Array:
    """Follower behind a gap of `width` that stays where no flank takes it, minus x, (n,): -width/2..width/2.

    `start` is as for `released_play`.
    """
    still = np.zeros(len(x))
    return released_play(x, still, still, 0.0, width, np.inf, 1.0, start)


@compiled
def flight(x: Array, width: float, braking: float, period: float, start: float) -> Array:
    """Follower of some mass behind a gap of `width`, minus x, (n,): it flies on in the gap, and a flank takes it along.

    Between the flanks it keeps its speed but for a `braking`, m/s^2, by its own friction. `start` is as for `play`.
    """
    out = np.empty(len(x))
    half = 0.5 * width
    y, v = x[0] + start * half, 0.0
    out[0] = y - x[0]
    for k in range(1, len(x)):
        v -= math.copysign(min(braking * period, abs(v)), v)
        y += period * v
        speed = (x[k] - x[k - 1]) / period
        if y > x[k] + half:
            y, v = x[k] + half, min(v, speed)
        elif y < x[k] - half:
            y, v = x[k] - half, max(v, speed)
        out[k] = y - x[k]
    return out


@compiled
def oscillator(force: Array, frequency: float, damping: float, period: float) -> Array:
    """Response x of x'' + 2 z w x' + w^2 x = w^2 force (n, d), w = 2 pi frequency, with a static gain of one.

    It is exact for an input that is held from one sample to the next.
    """
    a11, a12, a21, a22 = swing_map(frequency, damping, period)
    out = np.zeros_like(force)
    for i in range(force.shape[1]):
        x, v = force[0, i], 0.0
        for k in range(force.shape[0]):
            out[k, i] = x
            dx = x - force[k, i]
            x = force[k, i] + a11 * dx + a12 * v
            v = a21 * dx + a22 * v
    return out


@compiled
def first_order(start: Array, middle: Array, end: Array, time_constant: float, period: float) -> Array:
    """First-order lag (n,) of an input that runs from start[k] to end[k] over the interval that ends at tick k.

    Args:
        start: (n,) the input behind the tick before.
        middle: (n,) its mean over the interval; it bends as a parabola does where that is not the mean of both ends.
        end: (n,) the input at the tick.
        time_constant: of the lag, s.
        period: of the ticks, s.

    It starts at rest at end[0] and is exact for such an input: a force law steps at a tick and moves on until the next.
    """
    out = np.empty(len(end))
    h = period / time_constant
    keep = math.exp(-h)
    share = (1.0 - keep) / h
    bulge = 6.0 * (h - 2.0 + (h + 2.0) * keep) / (h * h) if h > 0.01 else h
    y = end[0]
    for k in range(len(end)):
        bent = middle[k] - 0.5 * (start[k] + end[k])
        y = keep * y + (share - keep) * start[k] + (1.0 - share) * end[k] + bulge * bent
        out[k] = y
    return out


@compiled
def frozen_integral(
    force: Array,
    law: Array,
    step: Array,
    load: Array,
    travel: Array,
    axis: tuple[float, float, float, float, float],
    knee: float,
) -> Array:
    """Velocity error (n,) [m or rad] that the integrator of a clamped PI law has not summed up until each tick.

    A demand that steps at a tick lifts the force at once; the velocity then takes it down again, within the period as
    often as not. While it is clamped the axis accelerates evenly, so the time in the clamp follows from how far the
    force would go: from the force reported, or from the law where that is clamped itself.

    Args:
        force: (n,) reported just before the demand steps.
        law: (n,) that a drive without a clamp would give there.
        step: (n,) by how much the step of the demand lifts the force: gain times the change.
        load: (n,) force that holds the velocity.
        travel: (n,) integral of the velocity error over the period ahead of each tick.
        axis: gain and integral gain of the drive, mass, limit of the force, period [s].
        knee: of a limit that bends: the force falls behind the law from 1 - knee of the limit on, and the integrator
            stops where the law asks for 1 + knee of it.
    """
    gain, integral, mass, limit, period = axis
    straight, stop = (1.0 - knee) * limit, (1.0 + knee) * limit
    out = np.zeros(len(force))
    total = 0.0
    for k in range(len(force) - 1):
        now = force[k]
        free = law[k] - integral * total
        if abs(now) > NEAR_LIMIT * straight and abs(free) > straight and now * free > 0.0:
            now = free
        wanted = now + step[k]
        side = 1.0 if wanted > 0.0 else -1.0
        over, room = side * wanted - stop, limit - side * load[k]
        if over > 0.0 and room > 0.0:
            time = mass * over / (gain * room)
            if time >= period:
                total += travel[k]
            else:
                total += side * ((side * wanted - side * load[k]) / gain * time - 0.5 * room / mass * time * time)
        out[k + 1] = total
    return out


def second_difference(path: Array, period: float) -> Array:
    """Return the second difference of a path (n, ...), per s^2: the blow of a flank is in it."""
    out = np.zeros_like(path)
    out[1:-1] = np.diff(path, 2, axis=0) / period**2
    return out


def held_lag(x: Array, time_constant: float, period: float) -> Array:
    """First-order lag of x (n, d), exact for an input that is held from one sample to the next; at rest at first."""
    keep = math.exp(-period / time_constant)
    return _follow(np.ascontiguousarray(x, dtype=float), keep)


def lagged(x: Array, time_constant: float, period: float) -> Array:
    """First-order lag of x (n,), exact for an input that is linear between samples; settled at first."""
    before = np.concatenate([x[:1], x[:-1]])
    return first_order(before, 0.5 * (before + x), x, time_constant, period)


@compiled
def rate_limited(x: Array, start: float, limit: float, time_constant: float, period: float) -> Array:
    """Path (n,) from `start` that follows x (n,), held between samples: a first-order lag, no faster than `limit`."""
    out = np.empty(len(x))
    y = start
    share = 1.0 - math.exp(-period / time_constant)
    for k in range(len(x)):
        out[k] = y
        step = share * (x[k] - y)
        y += min(max(step, -limit * period), limit * period)
    return out


@compiled
def _follow(x: Array, keep: float) -> Array:
    """Return x (n, d) one sample late through y <- keep y + (1 - keep) x, at rest at first."""
    out = np.empty_like(x)
    for i in range(x.shape[1]):
        y = 0.0
        for k in range(len(x)):
            out[k, i] = y + x[0, i]
            y = (1.0 - keep) * (x[k, i] - x[0, i]) + keep * y
    return out


@compiled
def taken_by_limit(error: Array, start: float, gains: Array, time_constant: float, period: float) -> Array:
    """Force (n,) that a limit adds to a PI law on a velocity error (n,), both behind a first-order lag.

    Args:
        error: (n,) its mean over the interval that ends at each tick.
        start: the force at rest before the first tick.
        gains: proportional, integral, limit; the integrator rests while the limit holds and the error drives it on.
        time_constant: of the lag, s.
        period: of the ticks, s.
    """
    proportional, integral, limit = gains
    kept = math.exp(-period / time_constant)
    out = np.empty_like(error)
    ended, held, free, rest = start, start, start, start
    for k in range(len(error)):
        asked, wanted = proportional * error[k] + rest, proportional * error[k] + held
        given = min(max(wanted, -limit), limit)
        rest += integral * error[k] * period
        if given == wanted or error[k] * wanted < 0.0:
            held += integral * error[k] * period
        free, ended = asked + (free - asked) * kept, given + (ended - given) * kept
        out[k] = ended - free
    return out
