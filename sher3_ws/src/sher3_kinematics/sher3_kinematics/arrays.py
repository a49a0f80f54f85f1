"""Checks of vectors that come from outside, and compiled entry points that take the parameters as one array.

A Python call of a compiled function costs the unpacking of its arguments; an array unpacks faster than a long tuple.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sher3_common.compiled import compiled_ieee, direct

from sher3_kinematics import kernel
from sher3_kinematics.errors import BadInput
from sher3_kinematics.kernel import reach as kernel_reach
from sher3_kinematics.kernel.parameters import KernelParameters
from sher3_kinematics.kernel.parameters import unpack as unpack

Floats = NDArray[np.float64]
FLOAT64 = np.dtype(np.float64)
_ARRAY = np.ndarray
PARAMETERS = len(KernelParameters._fields)


def vector(values: Sequence[float] | Floats, size: int, name: str) -> Floats:
    """Return a contiguous finite vector (size,).

    Raises:
        BadInput: wrong shape, or a value that is not finite.
    """
    if is_plain(values, size) and math.isfinite(sum(values.tolist())):  # type: ignore[union-attr]
        return values  # type: ignore[return-value]
    try:
        result = np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise BadInput(f"{name} is not a vector of numbers", value=values, remedy=f"give {size} numbers") from None
    if result.shape != (size,):
        raise BadInput(f"{name} has the wrong shape", value=result.shape, limit=(size,), remedy=f"give {size} numbers")
    if not np.isfinite(result).all():
        raise BadInput(f"{name} is not finite", value=result.tolist(), remedy="check its source")
    return result


def is_plain(values: object, size: int) -> bool:
    """Return whether a value is a vector (size,) that needs no conversion, finite or not.

    This is the case of the control loop, and the test is several times faster than a conversion.
    """
    return type(values) is _ARRAY and values.dtype == FLOAT64 and values.shape == (size,) and values.flags.c_contiguous


def rows(values: Sequence[Sequence[float]] | Floats, size: int, name: str) -> Floats:
    """Return contiguous rows (n, size); rows that are not finite are let through and give NaN."""
    result = np.ascontiguousarray(values, dtype=np.float64)
    if result.ndim != 2 or result.shape[1] != size:
        raise BadInput(f"{name} has the wrong shape", value=result.shape, limit=("n", size), remedy="give one row each")
    return result


@compiled_ieee
def tip_transform(parameters: Floats, q: Floats) -> Floats:
    """Return T_bt (4, 4) for actuator positions (5,)."""
    transform = np.empty((4, 4))
    kernel.tip_pose_into(unpack(parameters), q, transform[:3, :3], transform[:3, 3])
    transform[3, 0] = transform[3, 1] = transform[3, 2] = 0.0
    transform[3, 3] = 1.0
    return transform


@compiled_ieee
def tip_jacobian(parameters: Floats, q: Floats) -> Floats:
    """Return the tip Jacobian (6, 5)."""
    return kernel.tip_jacobian(unpack(parameters), q)


@compiled_ieee
def pose_inverse(parameters: Floats, position: Floats, axis: Floats) -> tuple[Floats, bool]:
    """Return q (5,) for a tip position and a distal tool axis, and whether it is within travel and workspace.

    Behind the parameters stand eleven bounds: lower ends, upper ends, least elevation of the legs. Whatever is not
    finite is not within.
    """
    p = unpack(parameters)
    q, margins = np.empty(5), np.empty(5)
    kernel.pose_inverse_into(p, position[0], position[1], position[2], axis, q)
    kernel_reach.singularity_margins_into(p, q, margins)
    bounds, inside = parameters[PARAMETERS:], True
    for k in range(5):
        inside = inside and bounds[k] <= q[k] <= bounds[5 + k]
    for k in range(3):
        inside = inside and margins[k] >= bounds[10]
    return q, inside


@compiled_ieee
def gravity_load(parameters: Floats, q: Floats) -> Floats:
    """Return G(q) (5,)."""
    return kernel.gravity_load(unpack(parameters), q)


@compiled_ieee
def delta_forward(parameters: Floats, q: Floats) -> Floats:
    """Return the platform centre (3,) for slider positions (3,)."""
    return np.array(kernel.delta_forward(unpack(parameters), q[0], q[1], q[2]))


@compiled_ieee
def delta_inverse(parameters: Floats, centre: Floats) -> Floats:
    """Return the slider positions (3,) for a platform centre (3,)."""
    return np.array(kernel.delta_inverse(unpack(parameters), centre[0], centre[1], centre[2]))


@compiled_ieee
def delta_jacobian(parameters: Floats, q: Floats) -> Floats:
    """Return the Jacobian (3, 3) of the platform centre for slider positions (3,)."""
    return kernel.delta_jacobian(unpack(parameters), q[0], q[1], q[2])


@functools.cache
def entry(name: str) -> Callable[..., Any]:
    """Return the machine code of one of the functions above that the control loop calls; see `direct`."""
    vectors = {"tip_transform": (5,), "tip_jacobian": (5,), "pose_inverse": (3, 3)}[name]
    return direct(globals()[name], np.zeros(PARAMETERS), *map(np.zeros, vectors))
