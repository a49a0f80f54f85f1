"""Laws of one quantity, the words of a discovered formula: the diagnosis fits with them, the simulator runs on them.

A law takes a quantity x, the distance x moved since the last look, and what it remembers. `walk` is the same law along
a recorded signal. Direction is no sign function: `sliding` builds up over a displacement, as friction does, so that
noise of a reading at rest makes no direction.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sher3_common.compiled import compiled

Array = NDArray[np.float64]


class Law(NamedTuple):
    """One law.

    Attributes:
        code: its number in compiled code.
        shapes: names of its shape parameters, at most two.
        power: unit of its value is that of x to this power; 0 where it has none.
        shape_units: of each shape parameter: "x" where it is that of x.
        words: what it is, `{x}` the quantity and `{0}`, `{1}` the shape parameters.
    """

    code: int
    shapes: tuple[str, ...]
    power: int
    shape_units: tuple[str, ...]
    words: str


LAWS: dict[str, Law] = {
    "itself": Law(0, (), 1, (), "{x}"),
    "size": Law(1, (), 1, (), "the size of {x}"),
    "square": Law(2, (), 2, (), "the square of {x}"),
    "signed_square": Law(3, (), 2, (), "the square of {x}, with its sign"),
    "rising": Law(4, (), 1, (), "{x}, forward only"),
    "falling": Law(5, (), 1, (), "{x}, backward only"),
    "rising_square": Law(6, (), 2, (), "the square of {x}, forward only"),
    "falling_square": Law(7, (), 2, (), "the square of {x}, backward only"),
    "sine": Law(8, ("period",), 0, ("x",), "a sine of {x} with a period of {0}"),
    "cosine": Law(9, ("period",), 0, ("x",), "a cosine of {x} with a period of {0}"),
    "bump": Law(10, ("centre", "width"), 0, ("x", "x"), "a hump over {x} around {0}, {1} wide"),
    "beyond": Law(11, ("threshold",), 1, ("x",), "{x} beyond {0}"),
    "fading": Law(12, ("scale",), 0, ("x",), "a share that fades as {x} exceeds {0}"),
    "decaying": Law(13, ("scale",), 0, ("x",), "a share that decays with {x} over {0}"),
    "sliding": Law(14, ("displacement",), 0, ("x",), "the direction in which {x} changes, built up over {0}"),
    "play": Law(15, ("width",), 1, ("x",), "the lag of {x} behind a gap of {0}"),
    "late": Law(16, ("time_constant",), 1, ("s",), "the lag of {x} by a time constant of {0}"),
    "rate": Law(17, ("time_constant",), 1, ("s",), "the rate of change of {x}, smoothed over {0}"),
    "ringing": Law(19, ("frequency", "damping"), 1, ("Hz", "1"), "what swings at {0}, damped by {1}, under {x}"),
    "slow": Law(18, ("step",), 1, ("x",), "the lag of {x} behind what follows it by {0} a second at most"),
}
"""Every law by name. `late` is the lagged quantity less the quantity, `play` and `slow` the follower less what it
follows, `rate` its smoothed derivative, and `ringing` the answer of a mass on a spring, of x where x stands still."""
MEMORY = 2
"""Numbers that a law remembers."""
EARLIER = (1, 2, 3, 4, 6, 8, 12, 16)
"""Ticks by which commands and readings are compared with themselves: the usual laws there are of time."""
MOST_FACTORS = 3
"""Factors of one term that the simulator can hold."""


@compiled
def law_value(code: int, a: float, b: float, x: float, moved: float, memory: Array, period: float) -> float:
    """Return the value of a law.

    Args:
        code: of `LAWS`.
        a: first shape parameter.
        b: second one.
        x: the quantity.
        moved: its change since the last call.
        memory: (MEMORY,) what the law remembers; it changes.
        period: time since the last call, s.
    """
    if code == 0:
        return x
    if code == 1:
        return abs(x)
    if code == 2:
        return x * x
    if code == 3:
        return x * abs(x)
    if code == 4:
        return max(x, 0.0)
    if code == 5:
        return min(x, 0.0)
    if code == 6:
        return max(x, 0.0) ** 2
    if code == 7:
        return min(x, 0.0) ** 2
    if code == 8:
        return math.sin(2.0 * math.pi * x / a)
    if code == 9:
        return math.cos(2.0 * math.pi * x / a)
    if code == 10:
        return math.exp(-(((x - a) / b) ** 2))
    if code == 11:
        return math.copysign(max(abs(x) - a, 0.0), x)
    if code == 12:
        return math.exp(-((x / a) ** 2))
    if code == 13:
        return math.exp(-x / a)
    if code == 19:
        return x + _swing(a, b, moved, memory, period)
    memory[0] = _remembered(code, a, moved, memory[0], period)
    return memory[0]


@compiled
def _remembered(code: int, a: float, moved: float, z: float, period: float) -> float:
    """Return what a law of one memory is now, from what it was; its value is that."""
    if code == 14:
        end = math.copysign(1.0, moved)
        return end + (z - end) * math.exp(-abs(moved) / a)
    if code == 15:
        return min(max(z - moved, -0.5 * a), 0.5 * a)
    if code == 18:
        z -= moved
        return z - min(max(z, -a * period), a * period)
    keep = math.exp(-period / a)
    return keep * (z - moved) if code == 16 else keep * z + (1.0 - keep) * moved / period


@compiled
def swing_map(frequency: float, damping: float, period: float) -> tuple[float, float, float, float]:
    """Return what a period makes of offset and speed of x'' + 2 z w x' + w^2 x = 0, w = 2 pi frequency, by rows."""
    w = 2.0 * math.pi * frequency
    wd = w * math.sqrt(1.0 - damping * damping)
    e, c, s = math.exp(-damping * w * period), math.cos(wd * period), math.sin(wd * period)
    a12 = e * s / wd
    return e * (c + damping * w / wd * s), a12, -w * w * a12, e * (c - damping * w / wd * s)


@compiled
def _swing(frequency: float, damping: float, moved: float, memory: Array, period: float) -> float:
    """Return how far a mass on a spring is off x, which moved at the last sample; exact for an x held in between."""
    a11, a12, a21, a22 = swing_map(frequency, min(damping, 0.99), period)
    off, speed = memory[0], memory[1]
    memory[0] = a11 * off + a12 * speed - moved
    memory[1] = a21 * off + a22 * speed
    return float(memory[0])


@compiled
def walk(code: int, a: float, b: float, x: Array, period: float) -> Array:
    """Return a law along a signal x (n,) whose samples are `period` apart, (n,); it begins at rest."""
    out = np.empty(len(x))
    memory = np.zeros(MEMORY)
    for k in range(len(x)):
        moved = x[k] - x[k - 1] if k > 0 else 0.0
        out[k] = law_value(code, a, b, x[k], moved, memory, period)
    return out
