"""Short vectors as plain tuples of floats: fixed lengths have a name, so that a signature says what it takes.

Tuples are immutable, and compiled code takes them without a conversion. The units are SI; the frame is named where a
vector is used.
"""

from __future__ import annotations

from typing import TypeAlias

Vector: TypeAlias = tuple[float, ...]
"""Any number of components; (5,) are the actuators in their fixed order, m and rad."""

Vector3: TypeAlias = tuple[float, float, float]
"""x, y and z of one frame."""

Rotation: TypeAlias = tuple[float, float, float, float, float, float, float, float, float]
"""A rotation matrix, row by row."""

Twist: TypeAlias = tuple[float, float, float, float, float, float]
"""Linear velocity [m/s], then angular velocity [rad/s], of one frame."""

Wrench: TypeAlias = tuple[float, float, float, float, float, float]
"""Force [N], then torque [N m], of one frame."""

ZERO_TWIST: Twist = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
ZERO_WRENCH: Wrench = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
