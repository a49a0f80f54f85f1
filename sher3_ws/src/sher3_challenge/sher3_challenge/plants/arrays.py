"""Robots as named tuples of arrays, which compiled code takes as they are: made, copied, cut into axes."""

from __future__ import annotations

from typing import Any, NamedTuple, TypeVar

import numpy as np

from sher3_challenge.plants.plant import AXES, Array

T = TypeVar("T")


def zeros_of(kind: type[Any], **known: Array) -> Any:
    """Return a part whose unnamed values are zeros (5,)."""
    fields = {name: np.zeros(AXES) for name in kind._fields}
    return kind(**{**fields, **{name: np.array(value, dtype=float) for name, value in known.items()}})


def copied(whole: T) -> T:
    """Return a robot, or a part of one, whose arrays are its own."""
    if isinstance(whole, np.ndarray):
        return whole.copy()
    return type(whole)(*(copied(part) for part in whole))  # type: ignore[attr-defined]


def axis_slice(part: Any, j: int) -> Any:
    """Return a part of the robot for one axis: the same fields as numbers, and as the tables of that axis."""
    return type(part)(*(float(x[j]) if x.ndim == 1 else np.ascontiguousarray(x[j]) for x in part))


class Course(NamedTuple):
    """What the loop of a plant in compiled code leaves behind, all (n, 5) per tick."""

    command: Array  # host's velocity command
    echo: Array  # demand the drive executed in the interval that ended here
    motor: Array  # true motor position
    load: Array  # true load position
    force: Array  # force the drive makes, before noise
    motor_reading: Array
    load_reading: Array
