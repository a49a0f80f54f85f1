"""The two frames of a measurement: measured = Z * T(q) * X.

Z is the arm's base seen by the measuring system, X the measured body on the flange. Neither is known to a calibration;
they are found with everything else, so that no effect is blamed for what a frame explains.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Effect, Shape, Signature
from sher3_diagnosis.judge.causes import NUISANCE
from sher3_machines.errors import MachineError

from sher3_static.arm.kinematics import Arm, postures, transform
from sher3_static.arm.view import ArmView

TIP = Channel("mechanism", "tip")
"""The channel of the measured pose."""
ROUNDS = 5
"""Gauss-Newton rounds on the frames; the linear start is within a degree, and each round squares what is left."""
AMBIGUOUS = 1e-6
"""Smallest but one singular value over the largest below which the rotations of the frames cannot be told."""


class Frames(Effect):
    """Errors of the two frames: twelve columns that every fit carries."""

    id, family, stage = "measurement_frames", NUISANCE, "mechanism"
    explanation = "Where the measuring system and the measured body are is found with everything else."

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Return the measured pose."""
        return (TIP,)

    def signature(self, view: ArmView, site: str, shape: Shape) -> Signature:
        """Return turns and shifts of Z and X, per rad and m."""
        return Signature({TIP: frame_columns(view)})


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


def fitted_view(arm: Arm, q: Array, poses: Array, floor: Array) -> ArmView:
    """Return nominal postures with the frames that fit all measured poses best.

    Args:
        arm: nominal.
        q: (n, k) joint positions, rad.
        poses: (n, 4, 4) measured.
        floor: (6,) standard deviation of a measured position and orientation.

    Raises:
        MachineError: the postures do not tell the frames.
    """
    at = postures(arm, q)
    view = ArmView(arm, q, at, *hand_eye(at.tip, poses))
    for _ in range(ROUNDS):
        columns = (frame_columns(view) / floor[:, None]).reshape(-1, 12)
        step = np.linalg.lstsq(columns, (pose_error(view, poses) / floor).ravel(), rcond=1e-9)[0]
        base = transform(step[3:6], Rotation.from_rotvec(step[:3]).as_matrix()) @ view.base
        body = view.body @ transform(step[9:], Rotation.from_rotvec(step[6:9]).as_matrix())
        view = ArmView(arm, q, at, base, body)
    return view


def pose_error(view: ArmView, poses: Array) -> Array:
    """Return measured (n, 4, 4) against predicted poses, (n, 6): shift, m, and rotation vector, rad."""
    predicted = view.pose
    turn = poses[:, :3, :3] @ np.swapaxes(predicted[:, :3, :3], 1, 2)
    return np.concatenate([poses[:, :3, 3] - predicted[:, :3, 3], Rotation.from_matrix(turn).as_rotvec()], axis=1)


def hand_eye(tip: Array, poses: Array) -> tuple[Array, Array]:
    """Return Z and X, (4, 4) each, of poses = Z tip X, (n, 4, 4) each.

    Rotations come from the linear equations R_poses Y = R_Z R_tip with Y = R_X^T, positions from least squares after
    them (Shah, J. Mechanisms and Robotics 5, 2013).

    Raises:
        MachineError: the postures do not tell the rotations.
    """
    rows = [
        np.hstack([np.kron(b, np.eye(3)), -np.kron(np.eye(3), a.T)])
        for a, b in zip(tip[:, :3, :3], poses[:, :3, :3], strict=True)
    ]
    # Of the 9n rows only the directions of the 18 unknowns are asked for: all others cost n^2 in time and memory.
    values, null = np.linalg.svd(np.concatenate(rows), full_matrices=False)[1:]
    if values[-2] < AMBIGUOUS * values[0]:
        raise MachineError("the postures do not tell the frames", value=f"{values[-2]:.3g}", remedy="turn the tip more")
    y, r = (_nearest(null[-1, k : k + 9].reshape(3, 3)) for k in (0, 9))
    n = len(tip)
    a = np.zeros((3 * n, 6))
    a[:, :3] = (r @ tip[:, :3, :3]).reshape(-1, 3)
    a[:, 3:] = np.tile(np.eye(3), (n, 1))
    b = (poses[:, :3, 3] - tip[:, :3, 3] @ r.T).ravel()
    t = np.linalg.lstsq(a, b, rcond=None)[0]
    return transform(t[3:], r), transform(t[:3], y.T)


def _nearest(m: Array) -> Array:
    """Rotation nearest to a matrix (3, 3) known up to scale and sign."""
    m = m * np.sign(np.linalg.det(m))
    u, _, v = np.linalg.svd(m)
    return u @ np.diag([1.0, 1.0, np.linalg.det(u @ v)]) @ v
