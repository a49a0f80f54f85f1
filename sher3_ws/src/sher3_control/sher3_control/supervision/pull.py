"""What pulls at the tool before a tare: the drives hold it, though the sensor is about to call it zero."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable

import numpy as np
from sher3_common.samples import JointSample
from sher3_common.vectors import Vector
from sher3_kinematics import RobotKinematics

from sher3_control.errors import TareRefused
from sher3_control.settings import ControlSettings
from sher3_control.supervision.felt_twice import AXES, LEGS, FeltTwice


class Pull:
    """Judges the drives' efforts at rest against the weights of the robot file.

    Args:
        kinematics: of the robot.
        settings: `supervisor.hand_level`, what may be taken for granted, and `supervisor.hand_arm`.
    """

    def __init__(self, kinematics: RobotKinematics, settings: ControlSettings) -> None:
        self._limit = settings.supervisor.hand_level
        self._twice = FeltTwice(kinematics, settings.supervisor.hand_arm)
        self._reports: deque[tuple[Vector, Vector]] = deque(maxlen=settings.tare.samples)

    def hear(self, reports: Iterable[JointSample]) -> None:
        """Take the drives' reports since the last call."""
        self._reports.extend((r.position, r.effort) for r in reports if r.position is not None and r.effort is not None)

    def require_none(self) -> None:
        """Judge the mean of the newest reports, as many as a tare takes, the robot at rest and its drives in power.

        Raises:
            TareRefused: they hold more than the weights.
        """
        if not self._reports:
            return
        q, effort = np.mean(self._reports, axis=0)
        holds = self._twice.channels(q, np.zeros(6), effort)[1]
        size = max(float(np.linalg.norm(holds[:LEGS])), float(np.linalg.norm(holds[LEGS:AXES])))
        if not size <= self._limit:
            remedy = "let go of the tool, take away what lies on it, and tare again"
            what = "the drives hold a force at the tool [N]"
            raise TareRefused("pulled", what, value=size, limit=self._limit, remedy=remedy)
