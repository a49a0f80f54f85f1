"""The two frames of a measurement: measured = what is seen of Z * T(q) * X.

Z is the arm's base seen by the measuring system, X the measured body on the flange. Neither is known to a calibration;
they are found with everything else, so that no effect is blamed for what a frame explains.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation
from sher3_diagnosis.channel import Array
from sher3_machines.errors import MachineError

from sher3_static.arm.kinematics import Arm, postures, transform
from sher3_static.arm.sight import AMBIGUOUS, Sight
from sher3_static.arm.view import ArmView
from sher3_static.readings import Labels

ROUNDS = 5
"""Gauss-Newton rounds on the frames; the linear start is within a degree, and each round squares what is left."""


def frame_columns(view: ArmView) -> Array:
    """Return pose changes (n, 6, 12): turn about and shift along the measuring frame's axes, then the body's own."""
    pose = view.pose
    out = np.zeros((len(pose), 6, 12))
    for i, e in enumerate(np.eye(3)):
        out[:, :3, i], out[:, 3:, i] = np.cross(e, pose[:, :3, 3]), e
        out[:, :3, 3 + i] = e
        out[:, 3:, 6 + i] = pose[:, :3, i]
        out[:, :3, 9 + i] = pose[:, :3, i]
    return out


def set_up(view: ArmView, numbers: str) -> Array:
    """Return what is seen (n, d, p) of those numbers of the set-up that the instrument tells, or that have moved."""
    columns = view.sight.seen(frame_columns(view), view.pose)[:, :, list(getattr(view.sight, numbers))]
    zeros = np.ones((*columns.shape[:2], int(view.sight.zero)))
    return np.concatenate([columns, zeros], axis=2)


def started_view(arm: Arm, q: Array, measured: Array, run: Labels, sight: Sight) -> ArmView:
    """Return nominal postures with frames from linear equations: within a degree where arm and readings agree."""
    at = postures(arm, q)
    return ArmView(np.zeros(len(q)), arm, q, at, *sight.start(at.tip, measured, run), sight)


def fitted_view(arm: Arm, q: Array, measured: Array, run: Labels, floor: Array, sight: Sight) -> ArmView:
    """Return nominal postures with the frames that fit all readings best.

    Args:
        arm: nominal.
        q: (n, k) joint positions, rad.
        measured: readings of the instrument.
        run: (n,) number of the run.
        floor: (d,) standard deviation of a reading.
        sight: what the instrument sees.

    Raises:
        MachineError: the postures do not tell the frames.
    """
    view = started_view(arm, q, measured, run, sight)
    for _ in range(ROUNDS):
        columns = set_up(view, "identified") / floor[:, None]
        columns = columns.reshape(-1, columns.shape[2])
        error = (sight.error(view.pose, measured) / floor).ravel()
        step = np.zeros(12)
        step[list(sight.identified)] = np.linalg.lstsq(columns, error, rcond=1e-9)[0][: len(sight.identified)]
        base = transform(step[3:6], Rotation.from_rotvec(step[:3]).as_matrix()) @ view.base
        body = view.body @ transform(step[9:], Rotation.from_rotvec(step[6:9]).as_matrix())
        view = ArmView(view.warmth, arm, q, view.postures, base, body, sight)
    values = np.linalg.svd(columns / np.linalg.norm(columns, axis=0), compute_uv=False)
    if values[-1] < AMBIGUOUS * values[0]:
        raise MachineError("the postures do not tell the frames", value=f"{values[-1]:.3g}", remedy="turn the tip more")
    return view
