"""The postures of an arm as effects see them, through whatever instrument measures it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_effects.table_view import Still

from sher3_static.arm.kinematics import Arm, Postures
from sher3_static.arm.sight import Sight


@dataclass(frozen=True, eq=False)
class ArmView(Still):
    """Nominal postures with the two frames of the measurement: measured = what is seen of Z * T(q) * X.

    Attributes:
        arm: nominal.
        joints: (n, k) joint positions, rad or m.
        postures: nominal, in the base frame.
        base: (4, 4) Z, the arm's base in the measuring frame.
        body: (4, 4) X, the measured body on the flange.
        sight: what the instrument sees of a pose.
    """

    excitation = "postures"
    arm: Arm
    joints: Array
    postures: Postures
    base: Array
    body: Array
    sight: Sight

    @property
    def pose(self) -> Array:
        """Predicted pose (n, 4, 4) of the measured body in the measuring frame."""
        return self.base @ self.postures.tip @ self.body

    def row(self, site: str) -> int:
        """Return the number of a joint, from 0 at the base."""
        return self.arm.names.index(site)

    def own_axis(self, site: str) -> Array:
        """Return the axis of a joint in its own frame, a unit vector (3,)."""
        return self.arm.axes[self.row(site)]

    def place(self, site: str) -> Array:
        """Return where a joint is in the base frame, (n, 3), m."""
        return self.postures.frames[:, self.row(site), :3, 3]

    def carried(self, site: str) -> tuple[Array, Array]:
        """Return what a joint carries, in the base frame: the flange, and the middle of the links (n, 3) each, m."""
        behind = self.postures.frames[:, self.row(site) :, :3, 3]
        tip = self.postures.tip[:, :3, 3]
        return tip, np.concatenate([behind, tip[:, None]], axis=1).mean(axis=1)

    def turned(self, axis: Array, through: Array) -> Array:
        """Return the change (n, d) of what is seen per rad of a turn about `axis` through a point, (n, 3) each."""
        turn = self.base[:3, :3]
        u, p = axis @ turn.T, through @ turn.T + self.base[:3, 3]
        return self._observed(np.concatenate([np.cross(u, self.pose[:, :3, 3] - p), u], axis=1))

    def shifted(self, direction: Array) -> Array:
        """Return the change (n, d) of what is seen per m along `direction` (n, 3) in the base frame."""
        return self._observed(np.concatenate([direction @ self.base[:3, :3].T, np.zeros_like(direction)], axis=1))

    def _observed(self, change: Array) -> Array:
        return self.sight.seen(change[:, :, None], self.pose)[:, :, 0]

    def inputs(self, actuator: str) -> Array:
        """Return the joint positions (n, k), rad or m."""
        return self.joints
