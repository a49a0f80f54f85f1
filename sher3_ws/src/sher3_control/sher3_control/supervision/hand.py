"""Is there a hand where the force sensor says so? What the drives hold is the other witness.

A hand at the tip is felt twice: by the force sensor F, and by the legs, whose drives hold it with the forces u that
they report. At rest and in even motion F + J^-T u is what the platform weighs, whoever pushes (virtual work on the
delta's Jacobian J). So this sum does not change when the hand does; a sensor that stands, or is scaled, or pushes by
itself changes it. So do inertia, noise and friction: hence it looks only in even motion under an even push, through a
low pass, and with a limit that grows with the hand that both feel. Slow changes (bias, posture, temperature) are taken
for granted.
"""

from __future__ import annotations

import math

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
CALM = 2
"""Looks after uneven ones that do not count: the axes follow their commands, and hold a push, within 20 ms."""


class HandDetector(PlainDetector):
    """Watches the sum of the force sensor and the legs' forces while the drives have power.

    Args:
        kinematics: of the robot.
        settings: `hand_force`, `hand_share`, `hand_even`, `hand_jump`, `hand_lag`, `hand_memory`, `hand_settling`.
    """

    def __init__(self, kinematics: RobotKinematics, settings: SupervisorSettings) -> None:
        self._kinematics, self._settings = kinematics, settings
        self._known: tuple[Array, Array] | None = None
        self._peaks = (0.0, 0.0)
        self._command: Vector = (0.0,) * LEGS
        self._force = np.zeros(3)
        self._legs, self._seen = np.zeros(LEGS), -1
        self._uneven = 0
        self._last = self._since = -1
        self._found = Finding(Reason.HAND_DOUBTFUL, 0.0, settings.hand_force, "N", "force sensor")

    def begin(self) -> None:
        """Take the sum as it will be then for right: the drives have just got their power, or are about to."""
        self._known, self._since = None, -1
        self._found = self._found._replace(value=0.0)

    def feed(self, stamp: int, wrench: Vector, q: Vector, effort: Vector, command: Vector) -> None:
        """Take samples of one tick [ns].

        They count while neither the motion nor the sensor's force changes faster than `hand_even` and `hand_jump`, and
        the legs move as commanded: a leg that does not is another watch's business, and its inertia is no hand.

        Args:
            stamp: of the samples.
            wrench: of the force sensor in {f}, N and N m.
            q: load encoders (5,), m and rad.
            effort: forces of the drives (5,), N and N m.
            command: newest velocities of the axes (5,), m/s and rad/s.
        """
        joints = np.asarray(q)
        force = self._kinematics.transform_tip_to_base(joints)[:3, :3] @ np.asarray(wrench[:3])
        if not self._even(command[:LEGS], force, self._astray(stamp, joints[:LEGS], command[:LEGS])):
            return
        jacobian = self._kinematics.jacobian(joints)[:LEGS, :LEGS]
        held = np.linalg.solve(jacobian.T, np.asarray(effort[:LEGS]))
        self.follow(stamp, force, held)

    def _astray(self, stamp: int, legs: Array, command: Vector) -> float:
        """Return by how much the legs' speed since the last look differs from the command [m/s]; inf at the first."""
        moved, span = legs - self._legs, seconds(stamp - self._seen)
        known = self._seen >= 0 and span > 0.0
        self._legs, self._seen = legs, stamp
        return float(np.abs(moved / span - command).max()) if known else math.inf

    def _even(self, command: Vector, force: Array, astray: float) -> bool:
        """Return whether motion and push have been even for a while: a hit needs time to reach the drives."""
        faster = max([abs(new - old) for new, old in zip(command, self._command, strict=True)])
        harder = float(np.linalg.norm(force - self._force))
        self._command, self._force = command, force
        changes = max(faster, astray) > self._settings.hand_even or harder > self._settings.hand_jump
        self._uneven = CALM if changes else max(0, self._uneven - 1)
        return not self._uneven

    def follow(self, stamp: int, force: Array, held: Array) -> None:
        """Take the force of the sensor (3,) and what the legs hold (3,), N in {b}, of the tick `stamp` [ns]."""
        total, settings = force + held, self._settings
        step = min(settings.hand_look, seconds(stamp - self._last))
        self._last = stamp
        if self._since < 0:
            self._since = stamp
        settling = stamp - self._since < nanoseconds(settings.hand_settling)
        if self._known is None or not np.isfinite(total).all():
            self._known, self._peaks = (total, total), (0.0, 0.0)
            return
        quick, slow = self._known
        quick = quick + min(1.0, step / settings.hand_lag) * (total - quick)
        if settling:
            self._known = quick, quick
            return
        slow = slow + min(1.0, step / settings.hand_memory) * (total - slow)
        self._known = quick, slow
        keep = math.exp(-step / settings.hand_lag)
        felt = float(np.linalg.norm(force)), float(np.linalg.norm(held - slow))
        self._peaks = max(felt[0], keep * self._peaks[0]), max(felt[1], keep * self._peaks[1])
        limit = settings.hand_force + settings.hand_share * min(self._peaks)
        self._found = self._found._replace(value=float(np.linalg.norm(quick - slow)), limit=limit)

    def look(self, now: int) -> Finding:
        """Return how much of the force nobody holds."""
        return self._found

    def recover(self, now: int) -> None:
        """Take the sum as it is then for right."""
        self.begin()
