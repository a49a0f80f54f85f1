"""Is the whole report of a drive alive? An axis that is told to go either moves or pushes.

When both encoders and the torque repeat bit for bit while the commands would have moved the axis on, the report is
frozen and not the axis. An axis held by friction is not mistaken for it, because its drive winds up the torque.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from operator import eq

from sher3_common.reasons import Reason

from sher3_drivers.canopen.tpdo import DriveFeedback
from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.trips import Trip


class FrozenCheck:
    """Watches the reports of the five drives.

    Attributes:
        travel: commanded travel of each axis since its report last changed, m or rad.
        blind: a report is frozen, so nobody can tell whether that drive obeys.
    """

    def __init__(self, scales: Sequence[AxisScale], settings: MotorDriverSettings) -> None:
        self._scales = tuple(scales)
        self._limits = [settings.encoder_angle if s.revolute else settings.encoder_distance for s in scales]
        self._last: list[tuple[float, float, float]] = []
        self.travel = [0.0] * len(scales)
        self.blind = False

    def begin(self) -> None:
        """Start afresh."""
        self._last = []
        self.travel = [0.0] * len(self._scales)
        self.blind = False

    def check(
        self, feedback: DriveFeedback, commanded: Sequence[float], since: float, unheard: Collection[int] = ()
    ) -> Trip | None:
        """Judge a feedback.

        Args:
            feedback: what the drives said.
            commanded: velocities (5,) [m/s, rad/s] sent before it.
            since: time since the feedback before it, s.
            unheard: numbers of the axes without a report; they wait for the next one.
        """
        reports = list(zip(feedback.motor_position, feedback.load_position, feedback.effort, strict=True))
        before, self._last = self._last, reports
        for axis in unheard if before else ():
            reports[axis] = before[axis]
        if not any(map(eq, reports, before)):  # nearly always
            self.travel = [0.0] * len(self._scales) if before else self.travel
            return None
        for axis, report in enumerate(reports):
            if report != before[axis]:
                self.travel[axis] = 0.0
            if report != before[axis] or axis in unheard:
                continue
            travel = self.travel[axis] = self.travel[axis] + abs(commanded[axis]) * since
            if travel > self._limits[axis]:
                scale, limit, self.blind = self._scales[axis], self._limits[axis], True
                repeat = "encoders and torque repeat bit for bit"
                text = f"{scale.name}: {repeat}, told to go {travel:.3g} {scale.unit} meanwhile"
                return Trip(Reason.ENCODER_FROZEN, text, travel, limit, scale.unit)
        return None
