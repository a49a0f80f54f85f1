"""The postures of an arm as the measuring system sees them: what effects and the engine read."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array, Mask
from sher3_diagnosis.evidence import Motion

from sher3_static.arm.kinematics import Arm, Postures


@dataclass(frozen=True)
class ArmView:
    """Nominal postures with the two frames of the measurement: measured = Z * T(q) * X.

    Attributes:
        arm: nominal.
        joints: (n, k) joint positions, rad.
        postures: nominal, in the base frame.
        base: (4, 4) Z, the arm's base in the measuring frame.
        body: (4, 4) X, the measured body on the flange.
    """

    arm: Arm
    joints: Array
    postures: Postures
    base: Array
    body: Array

    @property
    def pose(self) -> Array:
        """Predicted pose (n, 4, 4) of the measured body in the measuring frame."""
        return self.base @ self.postures.tip @ self.body

    # what the effects read

    def row(self, site: str) -> int:
        """Return the number of a joint, from 0 at the base."""
        return self.arm.names.index(site)

    def own_axis(self, site: str) -> Array:
        """Return the axis of a joint in its own frame, a unit vector (3,)."""
        return self.arm.axes[self.row(site)]

    def place(self, site: str) -> Array:
        """Return where a joint is in the base frame, (n, 3), m."""
        return self.postures.frames[:, self.row(site), :3, 3]

    def turned(self, axis: Array, through: Array) -> Array:
        """Return the pose change (n, 6) per rad of a turn about `axis` (n, 3) through a point (n, 3), base frame."""
        turn = self.base[:3, :3]
        u, p = axis @ turn.T, through @ turn.T + self.base[:3, 3]
        return np.concatenate([np.cross(u, self.pose[:, :3, 3] - p), u], axis=1)

    def shifted(self, direction: Array) -> Array:
        """Return the pose change (n, 6) per m along `direction` (n, 3) in the base frame."""
        return np.concatenate([direction @ self.base[:3, :3].T, np.zeros_like(direction)], axis=1)

    # what the engine reads: postures are no course in time, and nothing but the joints is known of them

    @property
    def excitation(self) -> str:
        """Name of what was recorded."""
        return "postures"

    @property
    def rate(self) -> None:
        """None: postures are no course in time."""

    @property
    def loaded(self) -> Mask:
        """(n,) False: no load was recorded."""
        return np.zeros(len(self.joints), dtype=bool)

    @property
    def warmth(self) -> Array:
        """(n,) zero: temperatures are not recorded."""
        return np.zeros(len(self.joints))

    @property
    def temperature_known(self) -> bool:
        """False: temperatures are not recorded."""
        return False

    @property
    def speed_share(self) -> Array:
        """(n,) zero: the arm is at rest when it is measured."""
        return np.zeros(len(self.joints))

    def motion(self, actuator: str) -> Motion | None:
        """Return None: nothing moves."""
        return None

    def inputs(self, actuator: str) -> Array:
        """Return the joint positions (n, k), rad."""
        return self.joints
