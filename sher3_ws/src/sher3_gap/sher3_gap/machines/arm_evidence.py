"""Residuals of a serial arm: measured against nominal pose, with the two frames of the measurement free.

measured = Z * T(q) * X: Z is the arm's base seen by the measuring system, X the measured body on the flange. Both are
unknown to any calibration; their errors are columns of every fit, so that no effect is blamed for what a frame
explains.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
from scipy.spatial.transform import Rotation

from sher3_gap.channels import Array, Channel, Residual
from sher3_gap.fitting import Term, Whitened, make_term
from sher3_gap.library import LIBRARY, LibraryEffect, Shape, Signature, View
from sher3_gap.machines.arm_kinematics import Arm, Postures, postures, transform
from sher3_gap.machines.errors import MachineError

TIP = Channel("mechanism", "tip")
FOLDS = 10
"""Every tenth posture is held out in turn."""
UNUSED = 1.0e3
"""Floor (rad) of orientations that are not judged."""
ROUNDS = 5
"""Gauss-Newton rounds on the frames."""


@dataclass(frozen=True)
class ArmView:
    """Postures seen by the measuring system: positions, axes and directions are in its frame.

    Attributes:
        position: (n, 3) of the measured body; base: (3, 3) R of Z; flange: (n, 3, 3) R of Z T(q); postures: nominal.
    """

    position: Array
    base: Array
    origin: Array
    flange: Array
    postures: Postures

    def turned(self, axis: Array, through: Array) -> Array:
        """Pose change (n, 6) per rad of a turn about `axis` (n, 3) through a point (n, 3), in the base frame."""
        u, p = axis @ self.base.T, through @ self.base.T + self.origin
        return np.concatenate([np.cross(u, self.position - p), u], axis=1)

    def shifted(self, direction: Array) -> Array:
        """Pose change (n, 6) per m along `direction` (n, 3) in the base frame."""
        return np.concatenate([direction @ self.base.T, np.zeros_like(direction)], axis=1)


class Frames(LibraryEffect):
    """Errors of the two frames of the measurement: twelve columns that every fit carries."""

    id, family, stage = "measurement_frames", "nuisance", "mechanism"
    explanation = "Where the measuring system and the measured body are is found with everything else."

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """Turns and shifts of Z and X."""
        return Signature({TIP: frame_columns(view)})  # type: ignore[arg-type]


class JointEffect(LibraryEffect):
    """A geometric error of one joint.

    `encoder_offset`: its zero; `link_length_error`: where it sits; `rail_tilt`: how its axis lies.
    """

    family, stage = "geometry", "mechanism"

    def __init__(self, kind: str, arm: Arm, joint: int) -> None:
        self.id, self.joint, self.name = kind, joint, arm.names[joint]  # type: ignore[misc]
        self.axis = arm.axes[joint]
        self.explanation = LIBRARY[kind].explanation  # type: ignore[misc]

    def sites(self) -> tuple[str, ...]:
        """The joint."""
        return (self.name,)

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Seen at the measured body."""
        return (TIP,)

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """Columns per rad or m; a joint that reads too much makes the arm turn less: minus the turn."""
        seen: ArmView = view  # type: ignore[assignment]
        frame, turn = seen.postures.frames[:, self.joint], seen.postures.axes[:, self.joint]
        place = frame[:, :3, 3]
        if self.id == "encoder_offset":
            parts = [-seen.turned(turn, place)]
        elif self.id == "rail_tilt":
            across = np.linalg.svd(self.axis[None])[2][1:]
            parts = [seen.turned(frame[:, :3, :3] @ u, place) for u in across]
        else:
            parts = [seen.shifted(frame[:, :3, i]) for i in range(3)]
        return Signature({TIP: np.stack(parts, axis=-1)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Offset, tilts, or shifts along the joint frame's axes."""
        names = {"encoder_offset": ("offset",), "rail_tilt": ("tilt_1", "tilt_2"), "link_length_error": ("x", "y", "z")}
        return dict(zip(names[self.id], map(float, coefficients), strict=True))

    def unit(self, name: str, site: str) -> str:
        """Angles but for shifts."""
        return "m" if self.id == "link_length_error" else "rad"


@dataclass(frozen=True)
class ArmEvidence:
    """The engine's evidence for an arm: a fold of postures is a run."""

    runs: list
    views: list[ArmView]
    data: Whitened
    frames: Term

    @property
    def floors(self) -> list:
        """Floor per fold."""
        return self.data.floors


def gather_arm(arm: Arm, q: Array, poses: Array, noise: float, noise_rotation: float | None) -> ArmEvidence:
    """Residuals of all postures with the frames fitted to all, in folds.

    Raises:
        MachineError: the arm has another number of joints, or the frames cannot be told.
    """
    if q.shape[1] != len(arm.names):
        raise MachineError(
            "joint positions do not fit the arm", value=q.shape[1], limit=len(arm.names), remedy="correct the table"
        )
    at = postures(arm, q)
    z, x = hand_eye(at.tip, poses)
    floor = np.repeat([noise, noise_rotation or UNUSED], 3)
    for _ in range(ROUNDS):
        view, error = _against(at, poses, z, x)
        columns = (frame_columns(view) / floor[:, None]).reshape(-1, 12)
        step = np.linalg.lstsq(columns, (error / floor).ravel(), rcond=1e-9)[0]
        z = _moved(z, step[:6])
        x = x @ transform(step[9:], Rotation.from_rotvec(step[6:9]).as_matrix())
    view, error = _against(at, poses, z, x)
    folds = np.arange(len(q)) % FOLDS
    residuals = [{TIP: Residual(error, folds == k)} for k in range(FOLDS)]
    data = Whitened([view] * FOLDS, residuals, [{TIP: floor}] * FOLDS)  # type: ignore[list-item]
    runs = [SimpleNamespace(excitation="postures") for _ in range(FOLDS)]
    return ArmEvidence(runs, [view] * FOLDS, data, make_term(data, Frames(), "tip", {}))


def _against(at: Postures, poses: Array, z: Array, x: Array) -> tuple[ArmView, Array]:
    predicted = z @ at.tip @ x
    turn = poses[:, :3, :3] @ np.swapaxes(predicted[:, :3, :3], 1, 2)
    error = np.concatenate([poses[:, :3, 3] - predicted[:, :3, 3], Rotation.from_matrix(turn).as_rotvec()], axis=1)
    flange = (z @ at.tip)[:, :3, :3] @ x[:3, :3]
    return ArmView(predicted[:, :3, 3], z[:3, :3], z[:3, 3], flange, at), error


def frame_columns(view: ArmView) -> Array:
    """Pose changes (n, 6, 12): turn about and shift along the measuring frame's axes, then the measured body's own."""
    n = len(view.position)
    out = np.zeros((n, 6, 12))
    for i, e in enumerate(np.eye(3)):
        out[:, :3, i], out[:, 3:, i] = np.cross(e, view.position), e
        out[:, :3, 3 + i] = e
        out[:, 3:, 6 + i] = view.flange[:, :, i]
        out[:, :3, 9 + i] = view.flange[:, :, i]
    return out


def _moved(z: Array, step: Array) -> Array:
    return transform(step[3:], Rotation.from_rotvec(step[:3]).as_matrix()) @ z


def hand_eye(tip: Array, poses: Array) -> tuple[Array, Array]:
    """Z and X of poses = Z tip X.

    Rotations from the linear equations R_poses Y = R_Z R_tip (Y = R_X^T), then the positions.
    """
    rows = []
    for a, b in zip(tip[:, :3, :3], poses[:, :3, :3], strict=True):
        rows.append(np.hstack([np.kron(b, np.eye(3)), -np.kron(np.eye(3), a.T)]))
    values, null = np.linalg.svd(np.concatenate(rows))[1:]
    if values[-2] < 1e-6 * values[0]:
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
    """Rotation nearest to a matrix known up to scale and sign."""
    m = m * np.sign(np.linalg.det(m))
    u, _, v = np.linalg.svd(m)
    return u @ np.diag([1.0, 1.0, np.linalg.det(u @ v)]) @ v
