"""Sampled laws: curves drawn from a random source, and their look-up in compiled code.

A curve is a table of values at even steps. `at` clamps at the ends, `around` closes the table to a ring.
"""

from __future__ import annotations

import math

import numpy as np

from sher3_challenge.plants.compiled import compiled_inner
from sher3_challenge.plants.plant import Array

RING = 240
"""Nodes of a periodic table: ten orders of a sine stay within a per cent of its amplitude."""
CURVE = 33
"""Nodes of a table between two ends."""


@compiled_inner
def at(table: Array, x: float) -> float:
    """Return a table (m,) at a fraction `x` of its length, 0 to 1, linear between nodes."""
    u = min(max(x, 0.0), 1.0) * (len(table) - 1)
    i = min(int(u), len(table) - 2)
    return table[i] + (u - i) * (table[i + 1] - table[i])


@compiled_inner
def around(table: Array, turns: float) -> float:
    """Return a periodic table (m,) at a number of turns, linear between nodes."""
    n = len(table)
    u = (turns - math.floor(turns)) * n
    i = int(u)
    if i >= n:
        i, u = 0, 0.0
    following = table[i + 1] if i + 1 < n else table[0]
    return table[i] + (u - i) * (following - table[i])


@compiled_inner
def crept(z: float, dx: float, reach: float, slope: Array) -> float:
    """Return the state of a hysteresis in [-1, 1] after a travel `dx`.

    `slope` (m,) is dz/dx times `reach` over the state seen in the direction of travel, from -1 to 1.
    """
    if dx == 0.0:
        return z
    way = 1.0 if dx > 0.0 else -1.0
    z += way * min(2.0, abs(dx) / reach) * at(slope, 0.5 * (1.0 + way * z))
    return min(1.0, max(-1.0, z))


def ring(rng: np.random.Generator, width: float = 0.06) -> Array:
    """Return a random smooth ring (RING,) of mean 0 and rms 1; `width` is the share of the turn that hangs together."""
    distance = np.minimum(np.arange(RING), RING - np.arange(RING)) / RING
    window = np.exp(-0.5 * (distance / width) ** 2)
    values = np.real(np.fft.ifft(np.fft.fft(rng.standard_normal(RING)) * np.fft.fft(window)))
    values -= values.mean()
    return np.asarray(values / values.std())


def teeth(rng: np.random.Generator, order: float, phase: float, uneven: float) -> Array:
    """Return a ring (RING,) that repeats about `order` times: every tooth pointed, none like the next.

    Its projection on sin(order x + phase) is one; the share `uneven` of rms is left beside it.
    """
    x = 2 * math.pi * np.arange(RING) / RING
    wave = np.sin(order * x + phase)
    pointed = wave * (1.0 + 0.35 * np.cos(2 * (order * x + phase))) + 0.3 * ring(rng) * wave + 0.25 * ring(rng, 0.02)
    beside = pointed - 2 * np.mean(pointed * wave) * wave
    beside *= uneven * wave.std() / beside.std()
    return np.asarray(wave + beside - beside.mean())


def wobble(rng: np.random.Generator, size: float, nodes: int = CURVE) -> Array:
    """Return a random smooth curve (nodes,) about one with an rms of `size`."""
    x = np.linspace(0.0, 1.0, nodes)
    values = np.zeros(nodes)
    for k in (1, 2, 3):
        values += rng.standard_normal() / k * np.cos(k * math.pi * x + rng.uniform(0, 2 * math.pi))
    values -= np.mean(values)
    return np.asarray(1.0 + size * values / np.std(values))


def loop_slope(rng: np.random.Generator) -> Array:
    """Return the slope of a hysteresis (CURVE,), scaled so that its reach is the travel over which it turns to 1/e.

    Between a square root, which saturates after a finite travel, and an exponential, which never does; with bumps.
    """
    z = np.linspace(-1.0, 1.0, CURVE)
    slope = (1.0 - z) ** rng.uniform(0.4, 0.7) * wobble(rng, 0.12) + 1e-3
    before = z <= 1.0 - 2.0 / math.e
    travel = np.sum(np.diff(z[before]) / (0.5 * (slope[before][1:] + slope[before][:-1])))
    return np.asarray(slope * travel)
