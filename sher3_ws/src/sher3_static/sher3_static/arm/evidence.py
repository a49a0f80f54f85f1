"""Residuals of a serial arm: measured against nominal pose, with the two frames of the measurement free."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array, Residual
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, make_term
from sher3_diagnosis.fit.whitened import Whitened
from sher3_diagnosis.quantify.closure import residual_after
from sher3_machines.errors import MachineError
from sher3_machines.thresholds import FOLDS

from sher3_static.arm.frames import TIP, Frames, fitted_view, pose_error
from sher3_static.arm.kinematics import Arm
from sher3_static.arm.record import ArmData

NOT_JUDGED = 1.0e3
"""Floor of orientations that are not judged, rad: no orientation differs by a share of it."""


@dataclass(frozen=True, kw_only=True)
class ArmEvidence(Evidence):
    """The engine's evidence for an arm; a fold of postures is a run, and every fit carries the frames.

    Attributes:
        postures: number of postures in all.
    """

    postures: int

    def held_out(self, after: Fit) -> Array:
        """Return the position errors (n, 3), m, of postures under coefficients fitted to the other folds."""
        return np.concatenate([x[:, :3] for x in residual_after(self, after, TIP).values()])

    def seen(self, after: Fit) -> Array:
        """Return the position errors (n, 3), m, under coefficients fitted to all postures."""
        out = []
        for r, target in enumerate(self.data.target):
            columns = np.hstack([t.columns[r][TIP] for t in after.terms])
            out.append((target[TIP] - columns @ after.coefficients).reshape(-1, 6) * self.floors[r][TIP])
        return np.concatenate(out)[:, :3]


def gather_arm(arm: Arm, records: Sequence[ArmData], noise: float, noise_rotation: float | None) -> ArmEvidence:
    """Compute the residuals of all postures with the frames fitted to all, in folds.

    Args:
        arm: nominal.
        records: of the arm; their postures are taken together.
        noise: standard deviation of a measured position, m.
        noise_rotation: of an orientation, rad; None: orientations are not judged.

    Raises:
        MachineError: the arm has another number of joints, or the postures do not tell the frames.
    """
    q, poses = np.concatenate([r.joints for r in records]), np.concatenate([r.poses for r in records])
    if q.shape[1] != len(arm.names):
        raise MachineError(
            "joint positions do not fit the arm", value=q.shape[1], limit=len(arm.names), remedy="correct the table"
        )
    floor = np.repeat([noise, noise_rotation or NOT_JUDGED], 3)
    view = fitted_view(arm, q, poses, floor)
    error, fold = pose_error(view, poses), np.arange(len(q)) % FOLDS
    residuals = [{TIP: Residual(error, fold == k)} for k in range(FOLDS)]
    data = Whitened([view] * FOLDS, residuals, [{TIP: floor}] * FOLDS)
    return ArmEvidence(
        excitations=[view.excitation] * FOLDS,
        data=data,
        units={TIP: "m"},
        places={"joint": arm.names},
        rotary=frozenset(arm.names),
        nuisance=(make_term(data, Frames(), TIP.actuator, {}),),
        postures=len(q),
    )
