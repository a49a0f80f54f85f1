"""Records of a serial arm: joint positions, and poses of a body on its last link measured from outside."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sher3_gap.channels import Array
from sher3_gap.machines.description import ArmMachine
from sher3_gap.machines.errors import MachineError
from sher3_gap.machines.intake import pick
from sher3_gap.machines.tables import Tables

MIN_POSTURES = 20


@dataclass(frozen=True)
class ArmData:
    """`joints` (n, k) rad, `poses` (n, 4, 4) with positions in m."""

    name: str
    joints: Array
    poses: Array


def arm_data(name: str, tables: Tables, machine: ArmMachine) -> ArmData:
    """Check and scale one record. Raises `MachineError`."""
    joints = pick(machine.joint_positions, tables, name)
    poses = pick(machine.poses.model_copy(update={"unit": "1"}), tables, name).copy()
    if poses.shape != (len(joints), 4, 4) or joints.ndim != 2:
        raise MachineError(
            f"{name}: poses are not (n, 4, 4)", value=poses.shape, limit=(len(joints), 4, 4), remedy="reshape them"
        )
    if len(joints) < MIN_POSTURES:
        raise MachineError(f"{name}: too few postures", value=len(joints), limit=MIN_POSTURES, remedy="record more")
    if np.abs(joints).max() > 4.0 * np.pi:
        raise MachineError(
            f"{name}: joint positions: likely deg recorded as rad",
            value=f"{np.abs(joints).max():.4g}",
            limit="4 pi",
            remedy="state unit: deg",
        )
    poses[:, :3, 3] *= machine.poses.scale
    if np.abs(poses[:, :3, 3]).max() > 50.0:
        raise MachineError(
            f"{name}: positions: likely mm recorded as m",
            value=f"{np.abs(poses[:, :3, 3]).max():.4g}",
            limit="50 m",
            remedy="state unit: mm",
        )
    turn = poses[:, :3, :3]
    off = float(np.abs(turn @ np.swapaxes(turn, 1, 2) - np.eye(3)).max())
    if off > 1e-3:
        raise MachineError(
            f"{name}: a pose is no rotation", value=f"{off:.3g}", limit="1e-3", remedy="check the order of the entries"
        )
    return ArmData(name, joints, poses)
