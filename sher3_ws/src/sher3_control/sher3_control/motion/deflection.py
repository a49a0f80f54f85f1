"""Pose commands corrected by the deflection under load, so that the loaded tip reaches the commanded pose.

The deflection is modelled from the measured wrench. The correction follows the force, so it pushes further into
something stiff, which raises the force again. With the compliance C of the robot, C' of the model and the stiffness k
of what is touched, a change returns with the factor C' k / (1 + C k) in each round. The factor stays below one unless
the model is softer than robot and contact together, C' > C + 1/k. The compensation is off by default.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_common.reasons import Reason
from sher3_common.stamps import judge_age, nanoseconds
from sher3_common.vectors import Vector, Wrench
from sher3_description import Robot
from sher3_kinematics.tip_deflection import TipDeflection

from sher3_control.errors import CommandRejected
from sher3_control.law.tool_compensation import contact_wrench, wrench_at_tip
from sher3_control.law.wrench_gate import check_wrench
from sher3_control.motion.commands import PoseCommand
from sher3_control.motion.modes import require_finite
from sher3_control.settings import ControlSettings

Array = NDArray[np.float64]
NO_BIAS: Wrench = (0.0,) * 6


class CorrectedPose(NamedTuple):
    """A pose command with a corrected position; fields as in `PoseCommand`."""

    stamp: int
    position: Vector
    orientation: Vector


class DeflectionCompensation:
    """The filtered wrench and the elastic model.

    Args:
        robot: for the elastic model, the sensor and the tool.
        settings: limits of a believable wrench, cut-off of the filter.

    Attributes:
        bias: of the sensor (6,) from the newest tare [N, N m].
        filtered: the low-passed raw wrench (6,) in {f} [N, N m], None without a believable one.
    """

    def __init__(self, robot: Robot, settings: ControlSettings) -> None:
        self.bias = NO_BIAS
        self._model = TipDeflection(robot)
        self._sensor = robot.force_sensor
        self._range: Wrench = (*self._sensor.range_force, *self._sensor.range_torque)
        self._settings = settings.wrench
        self._age_limit = nanoseconds(settings.wrench.age_limit)
        self._period = nanoseconds(robot.control_period)
        self._share = 1.0 - math.exp(-2.0 * math.pi * settings.motion.deflection_cutoff * robot.control_period)
        self._stamp, self._newest, self._same = -1, NO_BIAS, 0
        self.filtered: Array | None = None

    def feed(self, stamp: int, sample: Vector) -> None:
        """Take a raw wrench (6,) in {f} with its stamp [ns]; one that is not believed empties the filter."""
        a, b, c, d, e, f = sample
        wrench: Wrench = (a, b, c, d, e, f)
        self._same = self._same + 1 if wrench == self._newest else 1
        self._stamp, self._newest = stamp, wrench
        if check_wrench(wrench, self._range, self._settings.saturation) is not Reason.MOVING:
            self.filtered = None
        elif self.filtered is None:
            self.filtered = np.array(wrench)
        else:
            self.filtered += self._share * (np.array(wrench) - self.filtered)

    def corrected(self, mode: str, command: PoseCommand, now: int, q: Vector) -> CorrectedPose:
        """Return the command with the deflection subtracted from its position.

        Args:
            mode: CRTK name of the command, for errors.
            command: tip pose in {b}.
            now: [ns].
            q: measured positions (5,).

        Raises:
            CommandRejected: there is no believable wrench, with the reason; or the position is not finite.
            LoadBeyondRange: the wrench less bias and weight is beyond the sensor's range.
        """
        position = require_finite(mode, command.position, 3, "coordinates")
        reason = self._judge(now)
        if reason is not Reason.MOVING or self.filtered is None:
            remedy = "check the force sensor, or switch motion.deflection_compensation off"
            raise CommandRejected(mode, f"deflection cannot be compensated ({reason.name})", remedy=remedy)
        place = self._model.compensated(q, self._at_tip(self.filtered, q), position)
        return CorrectedPose(command.stamp, tuple(place.tolist()), command.orientation)

    def _judge(self, now: int) -> Reason:
        """Return why the newest wrench is not believed at `now` [ns], MOVING when it is."""
        missing, stale = Reason.WRENCH_MISSING, Reason.WRENCH_STALE
        reason = judge_age(now, self._stamp, self._age_limit, self._period, missing, stale)
        if reason is Reason.MOVING:
            reason = Reason(check_wrench(self._newest, self._range, self._settings.saturation))
        if reason is Reason.MOVING and self._same >= self._settings.frozen_samples:
            return Reason.WRENCH_FROZEN
        return reason

    def _at_tip(self, raw: Array, q: Vector) -> Array:
        """Return the contact wrench (6,) at the tip in the axes of {b}, for a raw one in {f}."""
        rotation = self._model.kinematics.transform_tip_to_base(q)[:3, :3]
        a, b, c, d, e, f, g, h, i = rotation.ravel().tolist()
        flat, sensor = (a, b, c, d, e, f, g, h, i), self._sensor
        contact = contact_wrench(tuple(raw.tolist()), flat, float(sensor.tool_mass), sensor.tool_com, self.bias)
        at_tip = np.array(wrench_at_tip(contact, sensor.position))
        return np.concatenate((rotation @ at_tip[:3], rotation @ at_tip[3:]))
