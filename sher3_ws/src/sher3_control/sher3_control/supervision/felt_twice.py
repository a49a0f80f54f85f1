"""A hand at the tip, felt twice: by the force sensor, and by the drives that hold it (virtual work on the Jacobian).

The drives hold a hand with the efforts u that they report, beyond what their own motion takes and what the robot's
parts weigh: u - (m a + d v) - G(q). The sensor's contact wrench w, as J^T w, and that add up to zero, whoever pushes.
Five drives feel five channels: the force, by the legs, and the torques about the axes of roll and tilt. The sixth, a
torque about neither, moves no axis.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from sher3_common.compiled import compiled
from sher3_kinematics import RobotKinematics

Array = NDArray[np.float64]
LEGS, AXES = 3, 5


class Motion:
    """What the axes' own motion takes: the velocity that a drive makes of its commands lags by m/kp.

    Args:
        kinematics: of the robot, with the masses, the viscous friction and the gains of its drives.
    """

    def __init__(self, kinematics: RobotKinematics) -> None:
        axes = kinematics.robot.actuators
        self._mass, self._drag = np.array([axis.mass for axis in axes]), np.array([axis.viscous for axis in axes])
        self.lag = np.array([axis.mass / axis.drive.kp for axis in axes])
        self.begin(np.zeros(AXES))

    def begin(self, axes: Array) -> None:
        """Take the axes' positions (5,), m and rad, as those at rest."""
        self._meant, self._expected, self._true, self._axes = *np.zeros((3, AXES)), axes

    def advance(self, span: float, axes: Array, command: Array) -> tuple[Array, float]:
        """Go on by `span` [s]; return what the motion takes (5,), N and N m, and how far a leg's speed is off [m/s]."""
        share = np.minimum(1.0, span / self.lag)
        faster = share * (command - self._meant)
        self._meant = self._meant + faster
        # The noise of an encoder is kept from the true speed by the same low pass.
        self._expected = self._expected + share * (self._meant - self._expected)
        self._true = self._true + share * ((axes - self._axes) / span - self._true)
        self._axes = axes
        off = np.abs(self._true - self._expected)[:LEGS].max()
        return self._mass * faster / span + self._drag * self._meant, float(off)


@compiled
def five_channels(jacobian: Array, rotation: Array, contact: Array, held: Array, arm: float) -> Array:
    """Return what the sensor and what the drives feel, as rows (2, 5), N.

    Args:
        jacobian: of the tip (6, 5) in {b}; its first three columns turn nothing.
        rotation: of {t} in {b} (3, 3), or a larger matrix that begins with it.
        contact: wrench at the tip in {t} (6,), N and N m.
        held: what the drives hold of a hand (5,), N and N m.
        arm: lever at which a torque counts as a force [m].
    """
    wrench, efforts, out = np.zeros(6), np.zeros((2, 5)), np.zeros((2, 5))
    for i in range(3):
        for j in range(3):
            wrench[i] += rotation[i, j] * contact[j]
            wrench[3 + i] += rotation[i, j] * contact[3 + j]
    for k in range(5):
        efforts[1, k] = held[k]
        for i in range(6):
            efforts[0, k] += jacobian[i, k] * wrench[i]
    back = np.linalg.inv(jacobian[:3, :3].copy())
    for n in range(2):
        for i in range(3):
            for k in range(3):
                out[n, i] += back[k, i] * efforts[n, k]
        for k in range(3, 5):
            turn = math.sqrt(jacobian[3, k] ** 2 + jacobian[4, k] ** 2 + jacobian[5, k] ** 2)
            out[n, k] = efforts[n, k] / (turn * arm)
    return out


class FeltTwice:
    """Turns contact wrenches and drive efforts into the same five channels.

    Args:
        kinematics: of the robot.
        arm: lever [m] at which a torque counts as a force.
    """

    def __init__(self, kinematics: RobotKinematics, arm: float) -> None:
        self._kinematics, self._arm = kinematics, arm
        self.channels(np.zeros(5), np.zeros(6), np.zeros(5))  # compiled now

    def channels(self, q: Array, contact: Array, held: Array) -> tuple[Array, Array, Array]:
        """Return what sensor and drives feel (5,) each, N, and the Jacobian (6, 5).

        Args:
            q: load encoders (5,), m and rad.
            contact: wrench at the tip in {t} (6,), N and N m.
            held: efforts of the drives less what their motion takes (5,), N and N m.
        """
        transform, jacobian = self._kinematics.transform_tip_to_base(q), self._kinematics.jacobian(q)
        felt, holds = five_channels(jacobian, transform, contact, held - self._kinematics.gravity_load(q), self._arm)
        return felt, holds, jacobian
