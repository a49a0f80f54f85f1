"""Friction faults: each writes into the friction map of its axis, unevenly over place and direction."""

from __future__ import annotations

import math

import numpy as np

from sher3_challenge.plants.kinds import Catalogue
from sher3_challenge.plants.plant import Array
from sher3_challenge.plants.site import Site
from sher3_challenge.plants.tables.curves import CURVE, RING, ring, wobble
from sher3_challenge.plants.tables.parameters import PLACES, SPEEDS
from sher3_challenge.plants.tables.plant import Rig

CATALOGUE = Catalogue()
known = CATALOGUE.known
UNEVEN = 0.18
"""Rms over place by which a level of friction differs from its mean; the two directions differ by as much again."""


def speeds(rig: Rig, site: Site) -> Array:
    """Return the speeds (SPEEDS,) at the nodes of the friction map."""
    return np.asarray(rig.truth.motor.top[site.index] * np.linspace(0.0, 1.0, SPEEDS) ** 2)


def patches(rng: np.random.Generator) -> Array:
    """Return (2, 1, PLACES) how a level differs over direction and place, mean 1."""
    nodes = np.linspace(0, RING, PLACES, endpoint=False)
    along = np.array([np.interp(nodes, np.arange(RING), ring(rng, 0.02)) for _ in range(2)])
    sides = 0.4 * UNEVEN * rng.uniform(-1, 1) * np.array([[1.0], [-1.0]])
    return np.asarray(1 + UNEVEN * along + sides)[:, None, :]


@known
def coulomb_friction(rig: Rig, site: Site, force: float) -> None:
    """Friction of one level on the average."""
    level = force * wobble(site.rng, 0.06, SPEEDS)[None, :, None] * patches(site.rng)
    rig.truth.motor.friction[site.rows] += level


@known
def stribeck_friction(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Friction that falls with speed, with a longer tail than a bell curve has."""
    static, share = site.scaled(x, "force"), site.rng.uniform(0.1, 0.4)
    velocity = site.scaled(site.rng.uniform(4e-4, 1.6e-3), "speed")
    falls = 1 / (1 + (math.e - 1) * (speeds(rig, site) / velocity) ** 1.6)  # 1/e at `velocity`
    level = static * (share + (1 - share) * falls) * wobble(site.rng, 0.06, SPEEDS)
    rig.truth.motor.friction[site.rows] += level[None, :, None] * patches(site.rng)
    return {"static": static, "force": share * static, "velocity": velocity}


@known
def viscous_friction(rig: Rig, site: Site, extra: float) -> None:
    """More drag with speed, less than in proportion as a grease that shears."""
    v = speeds(rig, site)
    drag = extra * v * (1.2 - 0.5 * v / v[-1]) * wobble(site.rng, 0.02, SPEEDS)
    rig.truth.motor.friction[site.rows] += drag[None, :, None] * (1 + 0.3 * (patches(site.rng) - 1))


@known
def presliding_friction(rig: Rig, site: Site, force: float) -> dict[str, float]:
    """Friction that takes tens of micrometres to build up, along a measured loop."""
    reach = site.scaled(site.rng.uniform(20e-6, 80e-6), "length")
    rig.truth.motor.friction[site.rows] += force * (1 + 0.5 * (patches(site.rng) - 1))
    rig.truth.motor.reach[site.rows] = reach
    return {"displacement": reach}


@known
def position_friction(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Friction with narrow peaks along the stroke, one a period, of unlike height; next to none between them."""
    mean, period = site.scaled(x, "force") / 2, site.scaled(site.rng.uniform(0.8e-3, 2.6e-3), "length")
    m, peaks = rig.truth.motor, 4
    m.span[site.rows] = peaks * period
    place = np.linspace(0, peaks, PLACES, endpoint=False) + site.rng.uniform()
    heights = site.rng.uniform(0.85, 1.15, peaks)[np.floor(place).astype(int) % peaks]
    shape = (0.5 - 0.5 * np.cos(2 * np.pi * place)) ** 1.5 * heights
    m.friction[site.rows] += mean * (shape / shape.mean())[None, None, :] * np.ones((2, SPEEDS, 1))
    amplitude = 2 * mean * abs(np.mean(shape * np.exp(2j * np.pi * place))) / shape.mean()
    return {"force": mean, "amplitude": float(amplitude), "period": period}


@known
def friction_drift(rig: Rig, site: Site, force: float, time_constant: float) -> None:
    """Friction after standing, which runs in within seconds: fast at first, with a long end."""
    m, end = rig.truth.motor, 12.0
    m.fading_end[site.rows] = end
    m.fading[site.rows] += force * np.exp(-((np.linspace(0.0, end, CURVE) / time_constant) ** 0.7))
