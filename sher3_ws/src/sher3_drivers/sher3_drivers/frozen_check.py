"""Is a drive's whole report alive? An axis that is told to go either moves or pushes.

Both encoders and the torque bit for bit the same, while the commands sent would have moved the axis on: then it is the
report that stands, not the axis. An axis held by friction is not mistaken for it, since its drive winds up the torque.
"""

from __future__ import annotations

from collections.abc import Sequence

from sher3_description.reasons import Reason

from .feedback import Feedback
from .settings import MotorDriverSettings
from .trips import Trip
from .units import AxisScale


class FrozenCheck:
    """Watches the reports of the five drives.

    Attributes:
        way: what each axis was told to go since its report last changed, m or rad.
        blind: a report stands, so nobody can tell whether that drive obeys.
    """

    def __init__(self, scales: Sequence[AxisScale], settings: MotorDriverSettings) -> None:
        self._scales = tuple(scales)
        self._limits = [settings.encoder_angle if s.revolute else settings.encoder_distance for s in scales]
        self.begin()

    def begin(self) -> None:
        """Start afresh."""
        self.way, self.blind = [0.0] * len(self._scales), False
        self._last: list[tuple[float, float, float]] = []

    def check(self, feedback: Feedback, commanded: Sequence[float], since: float) -> Trip | None:
        """Judge a feedback against the velocities (5,) sent before it [m/s, rad/s], `since` s after the one before."""
        reports = list(zip(feedback.motor_position, feedback.load_position, feedback.effort, strict=True))
        before, self._last = self._last, reports
        for axis, report in enumerate(reports if before else ()):
            if report != before[axis]:
                self.way[axis] = 0.0
                continue
            way = self.way[axis] = self.way[axis] + abs(commanded[axis]) * since
            if way > self._limits[axis]:
                scale, limit, self.blind = self._scales[axis], self._limits[axis], True
                unit = "rad" if scale.revolute else "m"
                text = f"{scale.name}: encoders and torque repeat bit for bit, told to go {way:.3g} {unit} meanwhile"
                return Trip(Reason.ENCODER_FROZEN, text, way, limit, unit)
        return None
