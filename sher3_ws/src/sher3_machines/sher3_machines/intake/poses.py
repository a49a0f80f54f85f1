"""Measured poses as people have them: matrices, or a position with a quaternion or Euler angles."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import model_validator
from scipy.spatial.transform import Rotation
from sher3_diagnosis.channel import Array

from sher3_machines.errors import MachineError
from sher3_machines.intake.columns import pick
from sher3_machines.intake.fields import Column, Strict
from sher3_machines.intake.tables import Tables

FLAT = 16
"""Entries of a matrix (4, 4) in one row."""
UNIT_NORM = 1e-2
"""How far the norm of a recorded quaternion may be from one: rounding to two digits."""


class Turn(Strict):
    """An orientation in columns.

    Attributes:
        matrix: (n, 3, 3) or (n, 9).
        quaternion: (n, 4), or four columns; in the order that `order` names.
        order: `xyzw` as in ROS and SciPy, or `wxyz`.
        euler: (n, 3), or three columns, of angles about the axes that `axes` names.
        axes: as SciPy has them: `xyz` about fixed axes (roll, pitch, yaw of ROS), `ZYX` about turned ones.
    """

    matrix: Column | None = None
    quaternion: Column | tuple[Column, Column, Column, Column] | None = None
    order: Literal["xyzw", "wxyz"] = "xyzw"
    euler: Column | tuple[Column, Column, Column] | None = None
    axes: str = "xyz"

    @model_validator(mode="after")
    def _either(self) -> Turn:
        if sum(x is not None for x in (self.matrix, self.quaternion, self.euler)) != 1:
            raise ValueError("state either `matrix`, `quaternion` or `euler`")
        if len(self.axes) != 3:
            raise ValueError("axes are three letters of x, y, z")
        if not (self.axes.islower() or self.axes.isupper()) or set(self.axes.lower()) - set("xyz"):
            raise ValueError("axes are three of xyz (fixed) or XYZ (turned), not mixed")
        return self


class Pose(Turn):
    """A pose in columns: an orientation and a position.

    Attributes:
        position: (n, 3), or three columns of (n,).
    """

    position: Column | tuple[Column, Column, Column]


def poses_of(pose: Column | Pose, tables: Tables, run: str) -> Array:
    """Return measured poses as homogeneous transforms (n, 4, 4), positions in m.

    Raises:
        MachineError: a column is missing or has another shape, or a quaternion is no rotation.
    """
    if isinstance(pose, Column):
        found = pick(pose.model_copy(update={"unit": "1", "factor": 1.0}), tables, run).copy()
        if found.ndim == 2 and found.shape[1] == FLAT:
            found = found.reshape(-1, 4, 4)
        if found.ndim != 3 or found.shape[1:] != (4, 4):
            remedy = "give (n, 4, 4), (n, 16), or a position with a quaternion or Euler angles"
            raise MachineError(f"{run}: poses are not matrices", value=found.shape, limit="(n, 4, 4)", remedy=remedy)
        found[:, :3, 3] *= pose.scale
        return found
    position = together(pose.position, tables, run, 3)
    out = np.tile(np.eye(4), (len(position), 1, 1))
    out[:, :3, 3], out[:, :3, :3] = position, turns_of(pose, tables, run).as_matrix()
    return out


def turns_of(pose: Turn, tables: Tables, run: str) -> Rotation:
    """Return n recorded orientations.

    Raises:
        MachineError: a column is missing or has another shape, or an orientation is no rotation.
    """
    if pose.euler is not None:
        return Rotation.from_euler(pose.axes, together(pose.euler, tables, run, 3))
    if pose.matrix is not None:
        return _from_matrices(pick(pose.matrix, tables, run), run)
    assert pose.quaternion is not None
    found = together(pose.quaternion, tables, run, 4)
    norm = np.linalg.norm(found, axis=1)
    worst = int(np.argmax(np.abs(norm - 1.0)))
    if abs(norm[worst] - 1.0) > UNIT_NORM:
        remedy = "check the columns and `order`; an unset orientation is all zero"
        raise MachineError(
            f"{run}: a quaternion is no rotation", value=f"norm {norm[worst]:.3g}", limit="1", remedy=remedy
        )
    return Rotation.from_quat(found if pose.order == "xyzw" else found[:, [1, 2, 3, 0]])


def _from_matrices(found: Array, run: str) -> Rotation:
    """Return (n, 3, 3) or (n, 9) as rotations; raises MachineError where they are none."""
    if found.shape[1:] not in ((3, 3), (9,)):
        remedy = "give (n, 3, 3), (n, 9), a quaternion or Euler angles"
        raise MachineError(f"{run}: orientations are not matrices", value=found.shape, limit="(n, 3, 3)", remedy=remedy)
    turn = found.reshape(-1, 3, 3)
    off = np.abs(turn @ np.swapaxes(turn, 1, 2) - np.eye(3)).max(axis=(1, 2)) + (np.linalg.det(turn) < 0.0)
    worst = int(np.argmax(off))
    if off[worst] > UNIT_NORM:
        remedy = "check the order of the entries; a mirrored frame is none"
        raise MachineError(
            f"{run}: orientation {worst} is no rotation", value=f"{off[worst]:.3g}", limit=UNIT_NORM, remedy=remedy
        )
    return Rotation.from_matrix(turn)


def together(columns: Column | tuple[Column, ...], tables: Tables, run: str, width: int | None = None) -> Array:
    """Return one column of (n, width), or that many columns of (n,) side by side; raises MachineError otherwise.

    Any width will do where none is given.
    """
    given = columns if isinstance(columns, tuple) else (columns,)
    found = [pick(column, tables, run) for column in given]
    if len({len(x) for x in found}) > 1:
        raise MachineError(
            f"{run}: columns that stand side by side differ in length", value=[len(x) for x in found], remedy="cut them"
        )
    out = np.column_stack(found)
    if width is not None and out.shape[1] != width:
        name = given[0].column
        raise MachineError(
            f"{run}: {name} has another width", value=out.shape[1], limit=width, remedy="name its columns"
        )
    return out
