"""Readings of a force sensor: the checks that refuse a record no answer could rest on, their scatter, the load."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.constants import g
from scipy.spatial.transform import Rotation
from sher3_common.numbers.cross import skew
from sher3_diagnosis.channel import Array
from sher3_machines.errors import MachineError
from sher3_machines.intake.columns import pick
from sher3_machines.intake.poses import together, turns_of
from sher3_machines.intake.tables import Tables

from sher3_static.readings import (
    Labels,
    Readings,
    alive,
    as_weight,
    enough,
    one_hot,
    scatter_beyond,
    temperature,
    thinned,
)
from sher3_static.sensor.description import Applied, SensorDescription, Three
from sher3_static.sensor.frames import Frame, frames
from sher3_static.sensor.view import SensorView, TurnedView

LEAST_ROWS = 20
"""Readings that a record must have: ten numbers of a linear sensor, twice."""
LEAST_LOADS = 3
"""Different weights or levers that it must have: two tell no more than a line."""
SPREAD = 0.05
"""Smallest over largest singular value of the directions of gravity, below which one of them was hardly taken."""
STATED = 1.1
"""Error of the stated frame over that of the best one up to which the stated frame is believed: noise makes the wrong
frame better by less than a tenth with twenty readings. Set by that argument."""


CLEARLY = 0.5
"""Error of the forces in the other frame over that in the stated one, up to which they were given in the other."""
WEIGHS = 3.0
"""Weight over the error of the forces from which something hangs on a sensor."""


def read_sensor(name: str, tables: Tables, described: SensorDescription) -> Readings:
    """Check the columns of a file and bring them to SI units and the sensor's frame.

    Returns:
        `wrench` (n, 6), `temperature` (n,), and `turn` (n, 3, 3) or `applied` (n, 6).

    Raises:
        MachineError: a column is missing, readings are too few, dead or of another length, or conditions too alike.
    """
    force, torque = together(described.force, tables, name, 3), together(described.torque, tables, name, 3)
    conditions = _conditions(name, tables, described)
    lengths = {"force": len(force), "torque": len(torque), **{x: len(values) for x, values in conditions.items()}}
    if len(set(lengths.values())) > 1:
        remedy = "name columns of one table, or resample them to one clock"
        raise MachineError(f"{name}: columns differ in length", value=lengths, remedy=remedy)
    enough(f"{name}: too few readings", len(force), LEAST_ROWS, "record more orientations or weights")
    wrench = np.hstack([force, torque])
    for label, x in zip(("fx", "fy", "fz", "tx", "ty", "tz"), wrench.T, strict=True):
        alive(f"{name}: {label}", x, "check whether this channel is connected")
    _check_conditions(name, conditions)
    if described.expressed_in == "base":
        into = np.swapaxes(conditions["turn"], 1, 2)
        wrench = np.hstack([(into @ x[:, :, None])[:, :, 0] for x in (force, torque)])
    warm = temperature(described.temperature, len(force), tables, name)
    return thinned(name, {"wrench": wrench, "temperature": warm, **conditions})


def _conditions(name: str, tables: Tables, described: SensorDescription) -> dict[str, Array]:
    if described.orientation is not None:
        return {"turn": turns_of(described.orientation, tables, name).as_matrix()}
    assert described.applied is not None
    return {"applied": applied_wrench(described.applied, tables, name)}


def applied_wrench(applied: Applied, tables: Tables, name: str) -> Array:
    """Return the wrench (n, 6) of known loads about the sensor's origin; raises MachineError for columns."""
    if applied.force is not None and applied.torque is not None:
        return np.hstack([together(x, tables, name, 3) for x in (applied.force, applied.torque)])
    assert applied.weight is not None and applied.direction is not None
    weight = pick(applied.weight, tables, name) * as_weight(applied.weight)
    direction, lever = (_vectors(x, tables, name, len(weight)) for x in (applied.direction, applied.lever))
    size = np.linalg.norm(direction, axis=1, keepdims=True)
    nowhere = (size[:, 0] == 0.0) & (weight != 0.0)
    if nowhere.any():
        at = int(np.argmax(nowhere)) + 1
        raise MachineError(f"{name}: a weight pulls nowhere", value=f"row {at}", remedy="give its `direction`")
    force = weight[:, None] * direction / np.where(size, size, 1.0)
    return np.hstack([force, np.cross(lever, force)])


def _vectors(vector: Three | tuple[float, float, float], tables: Tables, name: str, rows: int) -> Array:
    """Return vectors (n, 3) of columns, or one vector for all rows."""
    if isinstance(vector, tuple) and not hasattr(vector[0], "column"):
        return np.tile(np.array(vector, dtype=float), (rows, 1))
    found = together(vector, tables, name, 3)  # type: ignore[arg-type]
    enough(f"{name}: too few rows of {vector}", len(found), rows, "name columns of one table")
    return found


def _check_conditions(name: str, conditions: dict[str, Array]) -> None:
    if "applied" in conditions:
        loads = len(np.unique(np.round(conditions["applied"], 6), axis=0))
        enough(f"{name}: too few different loads", loads, LEAST_LOADS, "apply more weights at more levers")
        return
    upright = conditions["turn"][:, 2, :]
    directions = np.linalg.svd(upright - upright.mean(axis=0), compute_uv=False)
    if directions[2] < SPREAD * directions[0]:
        raise MachineError(
            f"{name}: orientations are too alike to tell weight from bias",
            value=f"{directions[2] / max(directions[0], 1e-12):.2g}",
            limit=f"{SPREAD} of the widest direction",
            remedy="turn the sensor about two horizontal axes, also upside down",
        )


def scatter(view: SensorView, run: Labels) -> Array:
    """Return the standard deviation of a reading (6,): what no linear sensor in any frame, drifting, explains."""
    x = np.column_stack([one_hot(run), view.conditions, view.elapsed - 0.5, view.warmth])
    each, _ = scatter_beyond(x, view.reading)
    pooled = [np.sqrt(np.mean(each[part] ** 2)) for part in (slice(0, 3), slice(3, 6))]
    return np.repeat(np.maximum(pooled, np.finfo(float).eps), 3)


def identify(wrench: Array, turn: Array) -> tuple[float, Array]:
    """Return mass, kg, and first moment (3,), kg m, in the stated frame, from the frame in which readings fit best.

    A frame may be turned by any angle: each is tried as it is, and turned by what fits the forces best.
    """
    found = fit_of(wrench, turn)
    return found.mass, found.moment


class Hung(NamedTuple):
    """A load as readings in their best frame have it.

    Attributes:
        error: rms of the forces that it leaves, N.
        mass: kg.
        moment: (3,) first moment in the stated frame, kg m.
    """

    error: float
    mass: float
    moment: Array


def fit_of(wrench: Array, turn: Array) -> Hung:
    """Return the load in the frame in which readings (g, 6) fit best; in the stated one where that is as good."""
    tried = [(frame, np.eye(3)) for frame in frames()]
    view = TurnedView(np.zeros(len(wrench)), wrench, turn, 0.0, np.zeros(3), True)
    tried += [(f, Rotation.from_rotvec(view.turn(k)).as_matrix()) for k, f in enumerate(frames())]
    fits = [load_in(frame, wrench, turn, further) for frame, further in tried]
    best = min(range(len(fits)), key=lambda k: fits[k][0])
    chosen = 0 if fits[0][0] < STATED * fits[best][0] and fits[0][1] > 0.0 else best
    error, mass, moment = fits[chosen]
    frame, further = tried[chosen]
    return Hung(error, mass, frame.turn.T @ further.T @ moment)


def expressed_otherwise(wrench: Array, turn: Array, stated: str) -> Array | None:
    """Return the readings (n, 6) in the sensor's frame where they were given in the other frame than was stated.

    What hangs on a sensor turns in its frame and stays as it is in the base's, and its zero does the reverse: of both
    readings of a record the right one leaves clearly less of the forces, whatever the load and the zero. Readings that
    no load explains as stated, and one does in the other frame, are in that frame.

    Args:
        wrench: (n, 6) readings, brought into the sensor's frame as stated.
        turn: (n, 3, 3) stated orientations.
        stated: `sensor` or `base`.
    """
    into = turn if stated == "base" else np.swapaxes(turn, 1, 2)
    other = np.hstack([(into @ x[:, :, None])[:, :, 0] for x in (wrench[:, :3], wrench[:, 3:])])
    own, left = (fit_of(x, turn) for x in (wrench, other))
    hangs, turned = (found.mass * g > WEIGHS * found.error for found in (own, left))
    return other if turned and left.error < (CLEARLY if hangs else STATED) * own.error else None


def load_in(frame: Frame, wrench: Array, turn: Array, further: Array) -> tuple[float, float, Array]:
    """Return the rms error of the forces, N, mass and first moment of readings in one frame, with a free bias.

    Args:
        frame: of the list.
        wrench: (n, 6) readings.
        turn: (n, 3, 3) stated orientations.
        further: (3, 3) turn of the readings beyond that frame.
    """
    gravity = frame.gravity(turn) @ further.T
    centred, force = gravity - gravity.mean(axis=0), wrench[:, :3] - wrench[:, :3].mean(axis=0)
    mass = max(float(np.sum(centred * force) / np.sum(centred**2)), 0.0)
    torque = wrench[:, 3:] - wrench[:, 3:].mean(axis=0)
    moment = np.linalg.lstsq(-skew(centred).reshape(-1, 3), torque.ravel(), rcond=None)[0]
    return float(np.sqrt(np.mean((force - mass * centred) ** 2))), mass, moment
