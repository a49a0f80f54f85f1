"""Records of a serial arm: joint positions, and what an instrument outside sees of a body on its last link."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_machines.errors import MachineError
from sher3_machines.intake.columns import pick
from sher3_machines.intake.fields import Column
from sher3_machines.intake.poses import poses_of, together
from sher3_machines.intake.tables import Tables

from sher3_static.arm.description import ArmDescription
from sher3_static.readings import Readings, enough

MIN_POSTURES = 20
"""Postures a record must have: two for each fold that is held out."""
FURTHEST_TURN = 4.0 * np.pi
"""Joint position, rad, beyond which it is taken for degrees: no joint turns twice either way."""
FURTHEST = 50.0
"""Distance, m, beyond which a position is taken for millimetres."""
NOT_A_ROTATION = 1e-3
"""Largest entry of R R^T - I that rounding of the recorded entries explains."""


def read_arm(name: str, tables: Tables, machine: ArmDescription) -> Readings:
    """Check one record and bring it to SI units.

    Returns:
        `joints` (n, k), and `poses` (n, 4, 4), `positions` (n, 3) or `lengths` (n,).

    Raises:
        MachineError: a column is missing or has the wrong shape, postures are too few, a unit slips, or a pose is no
            rotation.
    """
    positions = machine.joint_positions
    joints = pick(positions, tables, name) if isinstance(positions, Column) else together(positions, tables, name)
    column, measured, places = _measured(name, tables, machine)
    if len(measured) != len(joints) or joints.ndim != 2:
        raise MachineError(
            f"{name}: {column} do not fit the joint positions",
            value=measured.shape,
            limit=f"{joints.shape[0]} rows",
            remedy="reshape them",
        )
    enough(f"{name}: too few postures", len(joints), MIN_POSTURES, "record more")
    _within(f"{name}: joint positions: likely deg recorded as rad", joints, FURTHEST_TURN, "4 pi", "state unit: deg")
    _within(f"{name}: {column}: likely mm recorded as m", places, FURTHEST, f"{FURTHEST:g} m", "state unit: mm")
    return Readings(name, {"joints": joints, column: measured})


def _measured(name: str, tables: Tables, machine: ArmDescription) -> tuple[str, Array, Array]:
    """Return the name of what was measured, its readings, and the lengths among them."""
    if machine.poses is not None:
        poses = poses_of(machine.poses, tables, name)
        _rotations(name, poses)
        return "poses", poses, poses[:, :3, 3]
    if machine.positions is not None:
        positions = together(machine.positions, tables, name, 3)
        return "positions", positions, positions
    assert machine.lengths is not None
    lengths = together(machine.lengths, tables, name, 1)[:, 0]
    return "lengths", lengths, lengths


def _rotations(name: str, poses: Array) -> None:
    turn = poses[:, :3, :3]
    off = float(np.abs(turn @ np.swapaxes(turn, 1, 2) - np.eye(3)).max())
    if off > NOT_A_ROTATION:
        remedy = "check the order of the entries"
        raise MachineError(
            f"{name}: a pose is no rotation", value=f"{off:.3g}", limit=f"{NOT_A_ROTATION:g}", remedy=remedy
        )


def _within(what: str, x: Array, furthest: float, limit: str, remedy: str) -> None:
    if (largest := float(np.abs(x).max())) > furthest:
        raise MachineError(what, value=f"{largest:.4g}", limit=limit, remedy=remedy)
