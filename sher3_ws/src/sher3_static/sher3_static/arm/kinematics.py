"""Forward kinematics of a serial arm."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation
from sher3_diagnosis.channel import Array

from sher3_static.arm.description import Joint


@dataclass(frozen=True)
class Arm:
    """Joint i turns by q about `axes[i]`, or slides along it, after the fixed transform `fixed[i]`; then `tip`.

    Attributes:
        names: of the k joints.
        fixed: (k, 4, 4).
        axes: (k, 3) unit vectors in the joints' own frames.
        tip: (4, 4).
        slides: names of those that slide; they move the arm, and errors are looked for in those that turn.
    """

    names: tuple[str, ...]
    fixed: Array
    axes: Array
    tip: Array
    slides: tuple[str, ...] = ()

    @property
    def turning(self) -> tuple[str, ...]:
        """The joints that turn."""
        return tuple(name for name in self.names if name not in self.slides)


@dataclass(frozen=True)
class Postures:
    """An arm along n postures, in the base frame.

    Attributes:
        tip: (n, 4, 4) flange.
        frames: (n, k, 4, 4) joint frames before their turn.
        axes: (n, k, 3) unit vectors along the joints' axes.
    """

    tip: Array
    frames: Array
    axes: Array


def arm_from_table(joints: Sequence[Joint], tip: float) -> Arm:
    """Build the arm of a modified Denavit-Hartenberg table (Craig: Introduction to Robotics, section 3.4).

    Args:
        joints: rows of the table.
        tip: from the last frame to the flange along z, m.
    """
    fixed = []
    for j in joints:
        about = transform(rotation=Rotation.from_rotvec([j.alpha, 0.0, 0.0]).as_matrix())
        turned = transform([0.0, 0.0, j.d], Rotation.from_rotvec([0.0, 0.0, j.offset]).as_matrix())
        fixed.append(about @ transform([j.a, 0.0, 0.0]) @ turned)
    axes = np.tile([0.0, 0.0, 1.0], (len(fixed), 1))
    return Arm(tuple(j.name for j in joints), np.array(fixed), axes, transform([0.0, 0.0, tip]))


def transform(position: Array | list[float] | None = None, rotation: Array | None = None) -> Array:
    """Return a homogeneous transform (4, 4) of a position (3,), m, and a rotation (3, 3)."""
    out = np.eye(4)
    if rotation is not None:
        out[:3, :3] = rotation
    if position is not None:
        out[:3, 3] = position
    return out


def postures(arm: Arm, q: Array) -> Postures:
    """Return the arm along joint positions (n, k), rad or m."""
    n, k = q.shape
    frames, axes = np.empty((n, k, 4, 4)), np.empty((n, k, 3))
    pose = np.tile(np.eye(4), (n, 1, 1))
    for i in range(k):
        pose = pose @ arm.fixed[i]
        frames[:, i], axes[:, i] = pose, pose[:, :3, :3] @ arm.axes[i]
        travel, moved = q[:, [i]] * arm.axes[i], np.tile(np.eye(4), (n, 1, 1))
        if arm.names[i] in arm.slides:
            moved[:, :3, 3] = travel
        else:
            moved[:, :3, :3] = Rotation.from_rotvec(travel).as_matrix()
        pose = pose @ moved
    return Postures(pose @ arm.tip, frames, axes)
