"""Effects outside the library that nobody wrote by hand: sentences of a small grammar of laws.

A law is *what it follows* (speed, force or place of another axis, or what its own axis did a while ago), *by which
shape* (straight, magnitude, square, bounded, wave), *carried by what* (nothing, the direction of travel, the own
force), *acting where* (the force of an axis, the reading of its encoder, the tip, the force sensor). No page of the
library follows another axis or remembers what an axis did.
"""

from __future__ import annotations

import math
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_description import ACTUATORS

from sher3_challenge.plants.compiled import compiled
from sher3_challenge.plants.declared import FORCE_SENSOR, TIP
from sher3_challenge.plants.kinds import Apply, Catalogue, Kind
from sher3_challenge.plants.site import ANGULAR, Site

Array = NDArray[np.floating[Any]]

NOWHERE, ON_FORCE, ON_READING, ON_TIP, ON_SENSOR = range(5)
SPEED, FORCE, PLACE = range(3)
STRAIGHT, MAGNITUDE, SQUARE, BOUNDED, WAVE = range(5)
PLAIN, DIRECTION, EFFORT = range(3)
SCALES = {SPEED: (8e-3, "speed"), FORCE: (4.0, "force"), PLACE: (1e-3, "length")}
"""What is large of a slider: m/s, N, m."""
SLIDES = 1e-3
"""Speed of a slider from which its direction is told [m/s]."""


MOST = 4.0
"""Size at which a law ends: one that feeds on itself must not run away."""


class Foreign(NamedTuple):
    """A law of the grammar as numbers, which compiled code takes as they are.

    Attributes:
        where: it acts; `on`: axis or component there; `gain`: of one in size.
        source, of: what it follows, of which axis; `scale`: what is large of that; `rest`: from where it counts places.
        time: of its memory [s], 0 without.
        shape, carrier: as above; `slides`, `effort`: scales of the carriers.
    """

    where: int = NOWHERE
    on: int = 0
    gain: float = 0.0
    source: int = SPEED
    of: int = 0
    scale: float = 1.0
    rest: float = 0.0
    time: float = 0.0
    shape: int = STRAIGHT
    carrier: int = PLAIN
    slides: float = 1.0
    effort: float = 1.0


NOTHING = Foreign()


@compiled
def foreign(law: Foreign, q: Array, v: Array, f: Array, memory: Array, period: float) -> float:
    """Return what a law adds at a tick, by positions `q`, speeds `v` and forces `f` (5,); `memory` (1,) moves on."""
    x = q[law.of] - law.rest
    if law.source == SPEED:
        x = v[law.of]
    elif law.source == FORCE:
        x = f[law.of]
    x /= law.scale
    if law.shape == MAGNITUDE:
        x = abs(x)
    elif law.shape == SQUARE:
        x = x * x
    elif law.shape == BOUNDED:
        x = math.tanh(2.0 * x)
    elif law.shape == WAVE:
        x = math.sin(3.0 * x)
    if law.time > 0.0:
        memory[0] += min(1.0, period / law.time) * (x - memory[0])
        x = memory[0]
    if law.carrier == DIRECTION:
        x *= math.tanh(v[law.on] / law.slides)
    elif law.carrier == EFFORT:
        x *= f[law.on] / law.effort
    return law.gain * min(MOST, max(-MOST, x))


@compiled
def along(law: Foreign, q: Array, v: Array, f: Array, period: float) -> Array:
    """Return (n,) what a law adds over a run of (n, 5) positions, speeds and forces."""
    out, memory = np.zeros(len(q)), np.zeros(1)
    for k in range(len(q)):
        out[k] = foreign(law, q[k], v[k], f[k], memory, period)
    return out


def added(law: Foreign, where: int, signal: Array, q: Array, f: Array, period: float) -> Array:
    """Return a signal (n, d) of tip or force sensor with what a law adds there."""
    if law.where != where:
        return signal
    out = signal.copy()
    out[:, law.on] += along(law, q, np.gradient(q, period, axis=0), f, period)
    return out


def unit(axis: int, dimension: str) -> float:
    """Return what one unit of a slider is on an axis."""
    return ANGULAR[dimension] if ACTUATORS[axis] == "roll" else 1.0


def sentence(where: int, source: int, remembers: bool, carrier: int) -> Apply:
    """Return what writes a law of these parts into a rig; shape, axis, memory and sign are its site's to draw."""

    def apply(rig: Any, site: Site, x: float) -> dict[str, float]:
        axes = len(ACTUATORS)
        own = site.actuator in ACTUATORS
        on = site.index if own else int(site.rng.integers(3))
        others = [j for j in range(axes) if not own or j != on]
        of = on if remembers and own else int(site.rng.choice(others))
        size, dimension = SCALES[source]
        gain = site.sign() * x * {ON_FORCE: unit(on, "force"), ON_READING: unit(on, "length")}.get(where, 1.0)
        time = float(np.exp(site.rng.uniform(math.log(0.2), math.log(2.0)))) if remembers else 0.0
        rig.foreign = Foreign(
            where, on, gain, source, of, size * unit(of, dimension), float(rig.region[of]), time,
            int(site.rng.integers(5)), carrier,
            SLIDES * unit(on, "speed") if own else 1.0, SCALES[FORCE][0] * unit(on, "force") if own else 1.0,
        )  # fmt: skip
        return {"gain": gain, "time_constant": time}

    return apply


_WHERE = {
    ON_FORCE: ("force", "motor_mechanics", ACTUATORS, (0.5, 0.01, 20.0), (PLAIN, DIRECTION, EFFORT)),
    ON_READING: ("reading", "sensing", ACTUATORS, (2e-6, 5e-8, 1e-4), (PLAIN, DIRECTION)),
    ON_TIP: ("tip", "mechanism", TIP, (8e-6, 3e-7, 3e-4), (PLAIN,)),
    ON_SENSOR: ("sensor", "sensing", FORCE_SENSOR, (0.03, 1e-3, 1.0), (PLAIN,)),
}
_SOURCES = {
    "speed_elsewhere": (SPEED, False),
    "force_elsewhere": (FORCE, False),
    "place_elsewhere": (PLACE, False),
    "speed_before": (SPEED, True),
    "force_before": (FORCE, True),
}
_CARRIERS = {PLAIN: "", DIRECTION: "_by_direction", EFFORT: "_by_force"}


def _drawn() -> Catalogue:
    found = Catalogue()
    for (where, (name, stage, places, sizes, carriers)), (follows, driver) in product(_WHERE.items(), _SOURCES.items()):
        source, remembers = driver
        if source == PLACE and where in (ON_TIP, ON_SENSOR):
            continue  # what the tip does by the place of an axis is a mechanism's error
        also = ("transmission",) if where == ON_READING else ()
        for carrier in carriers:
            key = f"{name}_follows_{follows}{_CARRIERS[carrier]}"
            law = sentence(where, source, remembers, carrier)
            found[key] = Kind("outside", stage, places, *sizes, also, name=key, apply=law)
    return found


CATALOGUE = _drawn()
"""The kinds of the grammar; each case of one has its own shape, axis, memory and sign."""
