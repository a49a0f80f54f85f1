"""What a gap is wide beneath the give of its flanks: read off where the load lies against one of them.

Behind a gap with elastic flanks the load trails by half the gap and by what the flank gives way under the force that it
passes on: friction of the load, against the motion, and whatever else pulls. A rigid gap takes the part of the friction
for its own. How much the flank gives way is told by the pull, which changes while the side does not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.quantify.jackknife import standard_error

from sher3_effects.view import AxisView

SLOW = 0.005
"""Share of its top speed from which an axis moves."""
SEATED = 5.0
"""Travel since the last reversal, in widths, from which the load lies against its flank."""
HELD = 0.8
"""Share of the friction up to which a pull cannot take the load across the gap."""
ENOUGH = 200
"""Samples of the residual grid below which nothing is told."""
CERTAIN = 2.0
"""Standard errors from which the flanks' give is more than chance."""


@dataclass(frozen=True)
class Plateau:
    """What the load's rest against its flanks tells.

    Attributes:
        width: of the gap, m or rad; `error`: its standard error, from leaving out one run after the other.
        lost: travel lost between the two directions: the gap and the give of its flanks.
    """

    width: float
    error: float
    lost: float


def plateau(views: Sequence[AxisView], site: str, width: float, friction: float) -> Plateau | None:
    """Return what the plateaus tell of a gap that has the `width` by the rigid law.

    Args:
        views: of all runs.
        site: the axis.
        width: of the rigid gap, m or rad.
        friction: of the load, N or N m.

    Returns:
        None where the samples are too few, and where the flanks' give is not told.
    """
    found = [x for view in views for x in [_seated(view, site, width, friction)] if len(x)]
    if len(found) < 3 or sum(map(len, found)) < ENOUGH or friction <= 0.0:
        return None
    every = [_solved(found[:k] + found[k + 1 :]) for k in range(len(found))]
    lost, give = _solved(found)
    widths = np.array([a - 2.0 * friction * b for a, b in every])
    gives = np.array([b for _, b in every])
    scatter = standard_error(gives)
    gap = lost - 2.0 * friction * give
    if give < CERTAIN * scatter or not 0.0 < gap < lost:
        return None
    return Plateau(gap, float(standard_error(widths)), lost)


def _seated(view: AxisView, site: str, width: float, friction: float) -> Array:
    """Return (m, 5) lag, side, pull, inertia and velocity of the samples at which the load lies against a flank."""
    run, axis = view.run, view.row(site)
    if run.load is None:
        return np.zeros((0, 5))
    position, velocity = view.position[:, axis], view.velocity[:, axis]
    side = np.sign(velocity)
    turned = np.concatenate([[0], np.flatnonzero(np.diff(side)) + 1])
    since = np.abs(position - position[turned][np.searchsorted(turned, np.arange(len(side)), side="right") - 1])
    pull = view.path.contact_force[:, axis] - view.path.gravity[:, axis]
    ok = run.inner & run.loaded_ok & (np.abs(velocity) > SLOW * view.axis(site).top) & (since > SEATED * width)
    ok &= np.abs(pull) < HELD * friction
    lag = run.to_grid(run.load - run.motor)[:, axis]
    inertia = view.axis(site).mass * view.acceleration[:, axis]
    return np.column_stack([lag, -0.5 * side, pull, inertia, velocity])[ok]


def _solved(runs: Sequence[Array]) -> tuple[float, float]:
    """Return the travel lost and the give per force; the zero of the two encoders is free in every run."""
    free = [x - x.mean(axis=0) for x in runs]
    table = np.vstack(free)
    scale = np.maximum(np.abs(table[:, 1:]).max(axis=0), 1e-300)
    found = np.linalg.lstsq(table[:, 1:] / scale, table[:, 0], rcond=1e-9)[0] / scale
    return float(found[0]), float(found[1])
