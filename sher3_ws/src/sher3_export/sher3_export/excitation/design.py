"""The motion that tells the constants of another machine apart best, among many within its recorded reach."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from sher3_chain.axes.command.law import is_law
from sher3_chain.axes.machine import Axes
from sher3_chain.manipulator.machine import Manipulator
from sher3_diagnosis.channel import Array

from sher3_export.errors import ExportError
from sher3_export.excitation.fourier import Box, Fourier, drawn, within

SECONDS, HARMONICS = 20.0, 5
"""Period, s, and harmonics: 0.05 to 0.25 Hz, so that most of the travel is used below the limits of speed."""
TRIED = 60
"""Motions that are compared."""
RATE = 100.0
"""Set-points per second, Hz."""
SAMPLES = 60
"""Moments of a period at which laws are compared."""
NULL = 1e-6
"""Singular value over the largest below which a combination of constants moves nothing in any motion."""
INSIDE = 0.95
"""Share of a recorded range, speed and acceleration that is used."""
Laws = Callable[[Array, Array, Array], Array]
"""Positions, velocities and accelerations (n, k) -> forces per constant, (n k, constants)."""


@dataclass(frozen=True)
class Excitation:
    """A motion to record.

    Attributes:
        joints: names.
        slides: whether each joint slides.
        motion: of a period.
        worst: smallest over largest singular value of the constants that the motion can tell at all, scaled to one.
        median: the same of the motions that it was chosen among.
        box: what the joints may do.
    """

    joints: Sequence[str]
    slides: Sequence[bool]
    motion: Fourier
    worst: float
    median: float
    box: Box

    @property
    def time(self) -> Array:
        """Times (n,) of the set-points, s."""
        return np.arange(int(self.motion.seconds * RATE) + 1) / RATE


def is_driven(machine: Any) -> bool:
    """Return whether a machine can be told to move: a chain of axes or an arm, none of whose joints swings freely."""
    return isinstance(machine, Axes | Manipulator) and not any(j.free for j in machine.described.chain)


def designed(machine: Any, runs: Sequence[Any], seed: int = 0) -> Excitation:
    """Design a motion for a chain of axes or an arm, within the range, speed and acceleration that its runs reached.

    Raises:
        ExportError: a joint did not move.
    """
    described = machine.described.chain
    names, slides = [j.name for j in described], [j.motion == "linear" for j in described]
    parts = [p for p in machine.gather(runs) if not is_law(p)]
    box = box_of([[v.run for v in p.records] for p in parts], names)
    laws: Laws = arm_laws(machine) if isinstance(machine, Manipulator) else axis_laws
    rng, t = np.random.default_rng(seed), np.linspace(0.0, SECONDS, 400)
    tried = [within(drawn(rng, len(names), HARMONICS, SECONDS), box, t) for _ in range(TRIED)]
    moments = np.linspace(0.0, SECONDS, SAMPLES, endpoint=False)
    values = [np.linalg.svd(scaled(laws(*m.motion(moments))), compute_uv=False) for m in tried]
    rank = max(int((s > NULL * s[0]).sum()) for s in values)
    worst = np.array([s[rank - 1] / s[0] for s in values])
    best = int(np.argmax(worst))
    return Excitation(names, slides, tried[best], float(worst[best]), float(np.median(worst)), box)


def box_of(runs: Sequence[Sequence[Any]], names: Sequence[str]) -> Box:
    """Return what the recorded signals of each part, all joints together, reached; raises ExportError at rest."""
    low, high, speed, acceleration = (
        np.concatenate([np.stack([f(r) for r in of_part]).max(axis=0) for of_part in runs])
        for f in (
            lambda r: -r.smooth.min(axis=0),
            lambda r: r.smooth.max(axis=0),
            lambda r: np.abs(r.velocity).max(axis=0),
            lambda r: np.abs(r.acceleration).max(axis=0),
        )
    )
    if len(high) != len(names) or not ((high + low > 0.0) & (speed > 0.0) & (acceleration > 0.0)).all():
        remedy = "record every joint in motion once: its range is what the design keeps to"
        raise ExportError("a joint did not move", value=f"{len(names)} joints", remedy=remedy)
    margin = 0.5 * (1.0 - INSIDE) * (high + low)
    return Box(margin - low, high - margin, INSIDE * speed, INSIDE * acceleration)


def axis_laws(q: Array, v: Array, a: Array) -> Array:
    """Return (n k, 5 k) of motions (n, k): mass, viscous and dry friction, spring and a constant of each axis."""
    n, k = q.shape
    out = np.zeros((n, k, 5 * k))
    for i in range(k):
        parts = (a[:, i], v[:, i], np.sign(v[:, i]), q[:, i] - q[:, i].mean(), np.ones(n))
        out[:, i, 5 * i : 5 * i + 5] = np.stack(parts, axis=-1)
    return out.reshape(n * k, -1)


def arm_laws(arm: Manipulator) -> Laws:
    """Return the laws of an arm: its inertial parameters; viscous and dry friction and a constant force of joints."""

    def laws(q: Array, v: Array, a: Array) -> Array:
        bodies = arm.model.regressor(q, v, a)
        n, k, _ = bodies.shape
        own = np.zeros((n, k, 3 * k))
        for i in range(k):
            own[:, i, 3 * i : 3 * i + 3] = np.stack([v[:, i], np.sign(v[:, i]), np.ones(n)], axis=-1)
        return np.concatenate([bodies, own], axis=2).reshape(n * k, -1)

    return laws


def scaled(columns: Array) -> Array:
    """Return the columns (n, p) that are not zero, each of length one."""
    size = np.linalg.norm(columns, axis=0)
    return columns[:, size > NULL * size.max()] / size[size > NULL * size.max()]
