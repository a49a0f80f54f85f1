"""Is there a hand where the force sensor says so? What the drives hold is the other witness.

A hand at the tip is felt twice: by the force sensor F, and by the legs, whose drives hold it with the forces u that
they report, beyond what their own motion takes: u - (m a + d v). F + J^-T of that is what the platform weighs, whoever
pushes (virtual work on the delta's Jacobian J). So this sum does not change when the hand does; a sensor that stands,
or is scaled, or pushes by itself changes it. Noise does too, and friction: hence several low passes, the slower the
finer, and limits that grow with the hand that both feel. Slow changes (bias, posture, temperature) are taken for
granted.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from sher3_common.reasons import Reason
from sher3_common.stamps import nanoseconds, seconds
from sher3_common.vectors import Vector
from sher3_kinematics import RobotKinematics

from sher3_control.settings import SupervisorSettings
from sher3_control.supervision.detectors import Finding, PlainDetector

Array = NDArray[np.float64]
LEGS = 3
CALM = 0.02
"""Time [s] for which nothing counts after a leg strayed from its command: it comes back with kp/ki of its drive."""


class Motion:
    """What the legs' own motion takes: the velocity that a drive makes of its commands lags by m/kp.

    Args:
        kinematics: of the robot, with the masses, the viscous friction and the gains of its drives.
    """

    def __init__(self, kinematics: RobotKinematics) -> None:
        legs = kinematics.robot.actuators[:LEGS]
        self._mass, self._drag = np.array([leg.mass for leg in legs]), np.array([leg.viscous for leg in legs])
        self.lag = float(np.mean([leg.mass / leg.drive.kp for leg in legs]))
        self.begin(np.zeros(LEGS))

    def begin(self, legs: Array) -> None:
        """Take the legs' positions (3,), m, as those at rest."""
        self._meant, self._expected, self._true, self._legs = *np.zeros((3, LEGS)), legs

    def advance(self, span: float, legs: Array, command: Array) -> tuple[Array, float]:
        """Go on by `span` [s]; return what the motion takes (3,), N, and how far the speed is off its command [m/s]."""
        share = min(1.0, span / self.lag)
        faster = share * (command - self._meant)
        self._meant = self._meant + faster
        # The noise of an encoder is kept from the true speed by the same low pass.
        self._expected = self._expected + share * (self._meant - self._expected)
        self._true = self._true + share * ((legs - self._legs) / span - self._true)
        self._legs = legs
        return self._mass * faster / span + self._drag * self._meant, float(np.abs(self._true - self._expected).max())


class HandDetector(PlainDetector):
    """Watches the sum of the force sensor and the legs' forces while the drives have power.

    Args:
        kinematics: of the robot.
        settings: `hand_limits`, `hand_share`, `hand_astray`, `hand_gap`, `hand_memory`, `hand_settling`.
    """

    def __init__(self, kinematics: RobotKinematics, settings: SupervisorSettings) -> None:
        self._kinematics, self._settings, self._motion = kinematics, settings, Motion(kinematics)
        lags, limits = zip(*settings.hand_limits, strict=True)
        self._lags, self._limits = np.array(lags), np.array(limits)
        self._force: Array | None = None
        self._quick, self._slow = np.zeros((len(lags), 3)), np.zeros(3)
        self._both = np.zeros(len(lags))
        self._last = self._since = self._astray = -1
        self._found = Finding(Reason.HAND_DOUBTFUL, 0.0, min(limits), "N", "force sensor")

    def begin(self) -> None:
        """Take the sum as it will be then for right: the drives have just got their power, or are about to."""
        self._force, self._since, self._astray = None, -1, -1
        self._found = self._found._replace(value=0.0)

    def feed(self, stamp: int, wrench: Vector, q: Vector, effort: Vector, command: Vector) -> None:
        """Take the samples of one tick, each later than the one before.

        They count while the legs move as commanded: a leg that does not is another watch's business, and what it takes
        is no hand.

        Args:
            stamp: of the samples [ns].
            wrench: of the force sensor in {f}, N and N m.
            q: load encoders (5,), m and rad.
            effort: forces of the drives (5,), N and N m.
            command: velocities that the axes were told a tick before (5,), m/s and rad/s.
        """
        joints = np.asarray(q)
        force = self._kinematics.transform_tip_to_base(joints)[:3, :3] @ np.asarray(wrench[:3])
        span, forces = seconds(stamp - self._last), np.asarray(effort[:LEGS])
        if not np.isfinite([force, forces]).all():
            self.begin()
            return
        if self._force is None or not 0.0 < span <= self._settings.hand_gap:
            self._last, self._force = stamp, force
            self._motion.begin(joints[:LEGS])
            return
        took, astray = self._motion.advance(span, joints[:LEGS], np.asarray(command[:LEGS]))
        self._force = self._force + min(1.0, span / self._motion.lag) * (force - self._force)
        if astray > self._settings.hand_astray:
            self._astray = stamp + nanoseconds(CALM)
        if stamp <= self._astray:
            self._last = stamp
            return
        jacobian = self._kinematics.jacobian(joints)[:LEGS, :LEGS]
        self.follow(stamp, self._force, np.linalg.solve(jacobian.T, forces - took))

    def follow(self, stamp: int, force: Array, held: Array) -> None:
        """Take the force of the sensor (3,) and what the legs hold (3,), N in {b}, of the tick `stamp` [ns]."""
        total, settings = force + held, self._settings
        step, self._last = min(settings.hand_gap, seconds(stamp - self._last)), stamp
        if self._since < 0:
            self._since, self._slow = stamp, total
            self._quick, self._both = np.tile(total, (len(self._lags), 1)), np.zeros(len(self._lags))
        self._quick = self._quick + np.minimum(1.0, step / self._lags)[:, None] * (total - self._quick)
        known = seconds(stamp - self._since) - 0.5 * settings.hand_settling
        settled = known >= 0.5 * settings.hand_settling
        # The mean of the second half of the settling time, then with a memory.
        self._slow = self._slow + step / (settings.hand_memory if settled else max(step, known)) * (total - self._slow)
        both = min(float(np.linalg.norm(force)), float(np.linalg.norm(self._quick[0] - self._slow - force)))
        self._both = np.maximum(both, np.exp(-step / self._lags) * self._both)
        if not settled:
            self._quick = np.tile(self._slow, (len(self._lags), 1))
            return
        doubt = np.linalg.norm(self._quick - self._slow, axis=1)
        limits = self._limits + settings.hand_share * self._both
        worst = int(np.argmax(doubt / limits))
        self._found = self._found._replace(value=float(doubt[worst]), limit=float(limits[worst]))

    def look(self, now: int) -> Finding:
        """Return how much of the force nobody holds."""
        return self._found

    def recover(self, now: int) -> None:
        """Take the sum as it is then for right."""
        self.begin()
