"""Pose commands corrected by the modelled deflection of the measured wrench, so that the loaded tip is where they say.

The correction follows the force, so against something stiff it pushes on: with compliance C of the robot, C' of the
model and stiffness k of what is touched, each round returns C' k / (1 + C k) of a change. That is below one unless the
model is softer than robot and contact together, C' > C + 1/k. Off by default.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_description import Robot
from sher3_kinematics.tip_deflection import TipDeflection

from .commands import PoseCommand
from .errors import CommandRejected
from .law_parameters import nanoseconds
from .modes import Vector, require_finite
from .reasons import Reason
from .settings import ControlSettings
from .tool_compensation import contact_wrench, wrench_at_tip
from .wrench_check import Wrench, check_wrench, judge_age

Array = NDArray[np.float64]
NO_BIAS: Wrench = (0.0,) * 6


class CorrectedPose(NamedTuple):
    """A pose command with another position."""

    stamp: int
    position: Vector
    orientation: Vector


class DeflectionCompensation:
    """The filtered wrench and the elastic model.

    Attributes:
        bias: of the sensor (6,) from the newest tare [N, N m].
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
        self._filtered: Array | None = None

    def feed(self, stamp: int, sample: Vector) -> None:
        """Take a raw wrench (6,) in {f}; an unusable one is kept for the judgement and empties the filter."""
        a, b, c, d, e, f = sample
        wrench: Wrench = (a, b, c, d, e, f)
        self._same = self._same + 1 if wrench == self._newest else 1
        self._stamp, self._newest = stamp, wrench
        if check_wrench(wrench, self._range, self._settings.saturation) is not Reason.MOVING:
            self._filtered = None
        elif self._filtered is None:
            self._filtered = np.array(wrench)
        else:
            self._filtered += self._share * (np.array(wrench) - self._filtered)

    def corrected(self, mode: str, command: PoseCommand, now: int, q: Vector) -> CorrectedPose:
        """Return the command with the deflection at actuator positions q (5,) subtracted from its position.

        Raises:
            CommandRejected: no believable wrench, with the reason; or a position that is not finite.
            LoadBeyondRange: the wrench without bias and weight is beyond the sensor's range.
        """
        position = require_finite(mode, command.position, 3, "coordinates")
        reason = self._judge(now)
        if reason is not Reason.MOVING or self._filtered is None:
            remedy = "check the force sensor, or switch motion.deflection_compensation off"
            raise CommandRejected(mode, f"deflection cannot be compensated ({reason.name})", remedy=remedy)
        place = self._model.compensated(q, self._at_tip(self._filtered, q), position)
        return CorrectedPose(command.stamp, tuple(place.tolist()), command.orientation)

    def _judge(self, now: int) -> Reason:
        missing, stale = Reason.WRENCH_MISSING, Reason.WRENCH_STALE
        reason = judge_age(now, self._stamp, self._age_limit, self._period, missing, stale)
        if reason is Reason.MOVING:
            reason = Reason(check_wrench(self._newest, self._range, self._settings.saturation))
        if reason is Reason.MOVING and self._same >= self._settings.frozen_samples:
            return Reason.WRENCH_FROZEN
        return reason

    def _at_tip(self, raw: Array, q: Vector) -> Array:
        """Return the contact wrench (6,) at the tip, axes of {b}."""
        rotation = self._model.kinematics.transform_tip_to_base(q)[:3, :3]
        a, b, c, d, e, f, g, h, i = rotation.ravel().tolist()
        flat, sensor = (a, b, c, d, e, f, g, h, i), self._sensor
        contact = contact_wrench(tuple(raw.tolist()), flat, float(sensor.tool_mass), sensor.tool_com, self.bias)
        at_tip = np.array(wrench_at_tip(contact, sensor.position))
        return np.concatenate((rotation @ at_tip[:3], rotation @ at_tip[3:]))
