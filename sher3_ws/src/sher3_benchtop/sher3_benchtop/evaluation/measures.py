"""Figures from measured places: the paper's definitions, and those of ISO 9283 beside them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def motion_errors(places: Floats, targets: Floats, axis: int, spacing: float) -> Floats:
    """Return |measured - intended| (m, 2) [m] of the motions of one spacing along an image axis, over all point pairs.

    The paper's "relative positional accuracy": for two points in line and a spacing apart, the motion that was
    measured less the motion that was intended, along both image axes. We read "error" as its magnitude, since the
    table has no negative entries.

    Args:
        places: measured (n, 2) [m].
        targets: intended (n, 2) [m].
        axis: 0 or 1.
        spacing: of neighbours [m].
    """
    step = targets[None, :, :] - targets[:, None, :]
    wanted = np.zeros(2)
    wanted[axis] = spacing
    first, second = np.nonzero(np.abs(step - wanted).max(axis=2) < 1e-3 * spacing)
    return np.abs((places[second] - places[first]) - (targets[second] - targets[first]))


def groups(places: Floats, target: Ints) -> list[Floats]:
    """Return the places (visits, 2) of each target."""
    return [places[target == k] for k in np.unique(target)]


def repeatability(places: Floats, target: Ints) -> Floats:
    """Return the paper's repeatability (2,) [m]: per axis the standard deviation of a target's visits, then the mean.

    With n - 1 in the denominator; the paper does not say.
    """
    return np.array([visits.std(axis=0, ddof=1) for visits in groups(places, target)]).mean(axis=0)


class Iso9283(NamedTuple):
    """Pose accuracy AP and pose repeatability RP in the image plane [m], arrays (targets,)."""

    accuracy: Floats
    repeatability: Floats


def iso9283(places: Floats, target: Ints, targets: Floats) -> Iso9283:
    """Return AP and RP of ISO 9283:1998, sections 7.2.1 and 7.2.2, in the plane of a camera.

    AP is the distance of the barycentre of a target's visits from the target, RP the mean distance of the visits from
    the barycentre plus three of its standard deviations. The standard wants 30 visits in three dimensions and an
    absolute frame; here the measured grid is shifted, not turned, to the barycentre of the commanded one.
    """
    visits = groups(places, target)
    centres = np.array([v.mean(axis=0) for v in visits])
    wanted = targets[np.unique(target)]
    accuracy = np.linalg.norm(centres - centres.mean(axis=0) - (wanted - wanted.mean(axis=0)), axis=1)
    distance = [np.linalg.norm(v - c, axis=1) for v, c in zip(visits, centres, strict=True)]
    spread = np.array([d.mean() + 3.0 * d.std(ddof=1) for d in distance])
    return Iso9283(accuracy, spread)


def slope(force: Floats, displacement: Floats) -> float:
    """Return the compliance [m/N]: the least-squares slope of displacement (n,) [m] over force (n,) [N]."""
    f = force - force.mean()
    return float(f @ (displacement - displacement.mean()) / (f @ f))
