"""What an instrument sees of the pose of a body: all of it, its position, or its distance from one point."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation
from sher3_diagnosis.channel import Array
from sher3_machines.errors import MachineError

from sher3_static.arm.kinematics import transform
from sher3_static.readings import Labels, one_hot

AMBIGUOUS = 1e-6
"""Smallest but one singular value over the largest below which the rotations of the frames cannot be told."""
NOT_JUDGED = 1.0e3
"""Floor of orientations that are not judged, rad: no orientation differs by a share of it."""


class Sight(ABC):
    """An instrument that sees d numbers of a pose.

    Attributes:
        column: of the readings that it gives.
        what: it measures, in a word.
        identified: those of the twelve numbers of the two frames (turn and shift of the measuring frame, then of the
            body) that it can tell.
        moved: those of them that differ from run to run when the instrument was set up again.
        zero: whether it has a zero of its own.
    """

    column: ClassVar[str]
    what: ClassVar[str]
    identified: ClassVar[Sequence[int]]
    moved: ClassVar[Sequence[int]]
    zero: ClassVar[bool]

    @abstractmethod
    def floor(self, noise: float, noise_rotation: float | None) -> Array:
        """Return the standard deviation (d,) of a reading."""

    @abstractmethod
    def start(self, tip: Array, measured: Array, run: Labels) -> tuple[Array, Array]:
        """Return a start of both frames, (4, 4) each, from nominal flange poses (n, 4, 4) and readings of runs."""

    @abstractmethod
    def error(self, pose: Array, measured: Array) -> Array:
        """Return readings less what is seen of predicted poses (n, 4, 4), (n, d)."""

    @abstractmethod
    def seen(self, change: Array, pose: Array) -> Array:
        """Return what is seen (n, d, p) of changes (n, 6, p) of poses (n, 4, 4): shift, m, then turn, rad."""


class PoseSight(Sight):
    """A tracker of six components: position, and orientation as far as its noise is stated."""

    column, what, zero = "poses", "position", False
    identified, moved = range(12), range(6)

    def floor(self, noise: float, noise_rotation: float | None) -> Array:
        """Return the noise (6,) of positions, m, and of orientations, rad, which without one are not judged."""
        return np.repeat([noise, noise_rotation or NOT_JUDGED], 3)

    def start(self, tip: Array, measured: Array, run: Labels) -> tuple[Array, Array]:
        """Return the frames (4, 4) of the linear equations; raises MachineError where the postures do not tell them."""
        return hand_eye(tip, measured)

    def error(self, pose: Array, measured: Array) -> Array:
        """Return the shift, m, and the rotation vector, rad, (n, 6)."""
        turn = measured[:, :3, :3] @ np.swapaxes(pose[:, :3, :3], 1, 2)
        return np.concatenate([measured[:, :3, 3] - pose[:, :3, 3], Rotation.from_matrix(turn).as_rotvec()], axis=1)

    def seen(self, change: Array, pose: Array) -> Array:
        """Return all of the change, (n, 6, p)."""
        return change


class PositionSight(Sight):
    """A tracker of one target: three components, and no orientation."""

    column, what, zero = "positions", "position", False
    identified, moved = (0, 1, 2, 3, 4, 5, 9, 10, 11), range(6)

    def floor(self, noise: float, noise_rotation: float | None) -> Array:
        """Return the noise (3,) of a position, m."""
        return np.repeat(noise, 3)

    def start(self, tip: Array, measured: Array, run: Labels) -> tuple[Array, Array]:
        """Return frames (4, 4) from S p = R x + t + c, linear in the turn S of the measuring frame, body x and c."""
        n = len(tip)
        rows = np.zeros((3 * n, 15))
        rows[:, :9] = np.einsum("nk,ij->nijk", measured, np.eye(3)).reshape(3 * n, 9)
        rows[:, 9:12], rows[:, 12:] = -tip[:, :3, :3].reshape(-1, 3), np.tile(-np.eye(3), (n, 1))
        found = np.linalg.lstsq(rows, tip[:, :3, 3].ravel(), rcond=None)[0]
        turn = nearest(found[:9].reshape(3, 3)).T
        return transform((-turn @ found[12:]).tolist(), turn), transform(found[9:12])

    def error(self, pose: Array, measured: Array) -> Array:
        """Return the shift (n, 3), m."""
        return measured - pose[:, :3, 3]

    def seen(self, change: Array, pose: Array) -> Array:
        """Return the shift (n, 3, p) of the change."""
        return change[:, :3]


class LengthSight(Sight):
    """A cable or a ball bar from one point: its length alone, with a zero of its own."""

    column, what, zero = "lengths", "length", True
    identified, moved = (3, 4, 5, 9, 10, 11), ()

    def floor(self, noise: float, noise_rotation: float | None) -> Array:
        """Return the noise (1,) of a length, m."""
        return np.array([noise])

    def start(self, tip: Array, measured: Array, run: Labels) -> tuple[Array, Array]:
        """Return the frames (4, 4) whose lengths fit best, from a start linear in anchor, body and their products."""
        turn, t, length = tip[:, :3, :3], tip[:, :3, 3], measured
        own = one_hot(run)
        rows = [2.0 * np.einsum("nji,nj->ni", turn, t), -2.0 * t, -2.0 * turn.reshape(-1, 9)]
        linear = np.hstack([*rows, own, 2.0 * own * length[:, None]])
        found = np.linalg.lstsq(linear, length**2 - np.sum(t**2, axis=1), rcond=None)[0]

        def left(x: Array) -> Array:
            return length - own @ x[6:] - np.linalg.norm(turn @ x[:3] + t - x[3:6], axis=1)

        starts = [np.concatenate([found[:6], found[-own.shape[1] :]]), np.r_[found[:6], np.zeros(own.shape[1])]]
        best = min((least_squares(left, x, x_scale="jac") for x in starts), key=lambda fit: float(fit.cost)).x
        return transform(-best[3:6]), transform(best[:3])

    def error(self, pose: Array, measured: Array) -> Array:
        """Return by how much the length is off, (n, 1), m."""
        return (measured - np.linalg.norm(pose[:, :3, 3], axis=1))[:, None]

    def seen(self, change: Array, pose: Array) -> Array:
        """Return the shift along the cable, (n, 1, p)."""
        along = pose[:, :3, 3] / np.linalg.norm(pose[:, :3, 3], axis=1, keepdims=True)
        return np.einsum("ni,nip->np", along, change[:, :3])[:, None, :]


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
    y, r = (nearest(null[-1, k : k + 9].reshape(3, 3)) for k in (0, 9))
    n = len(tip)
    a = np.zeros((3 * n, 6))
    a[:, :3] = (r @ tip[:, :3, :3]).reshape(-1, 3)
    a[:, 3:] = np.tile(np.eye(3), (n, 1))
    b = (poses[:, :3, 3] - tip[:, :3, 3] @ r.T).ravel()
    t = np.linalg.lstsq(a, b, rcond=None)[0]
    return transform(t[3:], r), transform(t[:3], y.T)


def nearest(m: Array) -> Array:
    """Return the rotation nearest to a matrix (3, 3) known up to scale and sign."""
    m = m * np.sign(np.linalg.det(m))
    u, _, v = np.linalg.svd(m)
    return u @ np.diag([1.0, 1.0, np.linalg.det(u @ v)]) @ v
