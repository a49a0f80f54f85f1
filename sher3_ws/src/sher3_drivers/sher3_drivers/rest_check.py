"""Did the quick stop work? Every axis must rest after the braking time and stay where it then is."""

from __future__ import annotations

from collections.abc import Sequence

from sher3_description.reasons import Reason

from .feedback import Vector
from .settings import MotorDriverSettings
from .trips import Trip
from .units import AxisScale


class RestCheck:
    """Watches the motor encoders of a stopped robot.

    Attributes:
        resting: the braking time is over.
        disobeyed: an axis moved all the same.
    """

    def __init__(self, scales: Sequence[AxisScale], settings: MotorDriverSettings) -> None:
        self._names = [scale.name for scale in scales]
        self._units = ["rad" if scale.revolute else "m" for scale in scales]
        self._limits = [settings.rest_angle if scale.revolute else settings.rest_distance for scale in scales]
        self._brake = round(settings.brake_time * 1e9)
        self._place: Vector | None = None
        self.resting = self.disobeyed = False

    def begin(self) -> None:
        """Forget the last stop: another one begins."""
        self._place, self.resting, self.disobeyed = None, False, False

    def check(self, motor: Vector, since: int, now: int) -> Trip | None:
        """Judge the motor positions of a robot stopped at `since`; call it in every tick of the stop."""
        if now - since < self._brake:
            return None
        if self._place is None:
            self._place, self.resting = motor, True
            return None
        for name, unit, limit, place, here in zip(
            self._names, self._units, self._limits, self._place, motor, strict=True
        ):
            if abs(here - place) > limit:
                moved, self.disobeyed = abs(here - place), True
                text = f"{name}: moved {moved:.3g} {unit} after the quick stop (limit {limit:.3g})"
                return Trip(Reason.STOP_NOT_OBEYED, text, moved, limit, unit)
        return None
