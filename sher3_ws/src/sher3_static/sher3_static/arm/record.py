"""Records of a serial arm: joint positions, and poses of a body on its last link measured from outside."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_machines.errors import MachineError
from sher3_machines.intake.columns import pick
from sher3_machines.intake.poses import poses_of
from sher3_machines.intake.tables import Tables

from sher3_static.arm.description import ArmDescription

MIN_POSTURES = 20
"""Postures a record must have: two for each fold that is held out."""
FURTHEST_TURN = 4.0 * np.pi
"""Joint position, rad, beyond which it is taken for degrees: no joint turns twice either way."""
FURTHEST = 50.0
"""Distance, m, beyond which a position is taken for millimetres."""
NOT_A_ROTATION = 1e-3
"""Largest entry of R R^T - I that rounding of the recorded entries explains."""


@dataclass(frozen=True)
class ArmData:
    """One record of n postures of an arm with k joints.

    Attributes:
        name: of its file.
        joints: (n, k) rad.
        poses: (n, 4, 4) homogeneous transforms, positions in m.
        notes: what was done to the data: nothing.
    """

    name: str
    joints: Array
    poses: Array
    notes: Sequence[str] = ()


def arm_data(name: str, tables: Tables, machine: ArmDescription) -> ArmData:
    """Check one record and bring it to SI units.

    Raises:
        MachineError: a column is missing or has the wrong shape, postures are too few, a unit slips, or a pose is no
            rotation.
    """
    joints = pick(machine.joint_positions, tables, name)
    poses = poses_of(machine.poses, tables, name)
    if poses.shape != (len(joints), 4, 4) or joints.ndim != 2:
        raise MachineError(
            f"{name}: poses are not (n, 4, 4)", value=poses.shape, limit=(len(joints), 4, 4), remedy="reshape them"
        )
    if len(joints) < MIN_POSTURES:
        raise MachineError(f"{name}: too few postures", value=len(joints), limit=MIN_POSTURES, remedy="record more")
    _check_units(name, joints, poses)
    turn = poses[:, :3, :3]
    off = float(np.abs(turn @ np.swapaxes(turn, 1, 2) - np.eye(3)).max())
    if off > NOT_A_ROTATION:
        raise MachineError(
            f"{name}: a pose is no rotation",
            value=f"{off:.3g}",
            limit=f"{NOT_A_ROTATION:g}",
            remedy="check the order of the entries",
        )
    return ArmData(name, joints, poses)


def _check_units(name: str, joints: Array, poses: Array) -> None:
    turn, distance = float(np.abs(joints).max()), float(np.abs(poses[:, :3, 3]).max())
    if turn > FURTHEST_TURN:
        raise MachineError(
            f"{name}: joint positions: likely deg recorded as rad",
            value=f"{turn:.4g}",
            limit="4 pi",
            remedy="state unit: deg",
        )
    if distance > FURTHEST:
        raise MachineError(
            f"{name}: positions: likely mm recorded as m",
            value=f"{distance:.4g}",
            limit=f"{FURTHEST:g} m",
            remedy="state unit: mm",
        )
