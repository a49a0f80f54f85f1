"""Has an axis left the place that its commands add up to? Nothing is forgotten from one enabling to the next.

The judge is what was sent: the velocity commands on the wire, each held from one SYNC to the next, summed up. Both
encoders have to say that the axis is elsewhere; when they differ, that is the business of `watches.joints`. Of the rest
that the drive says only its force counts, since that is what holds the hand. A PI velocity loop (recorded-run contract,
section 3) exerts u = kp (c - v) + ki e, where e is the sum of (c - v): it has no steady error but the load over ki. Its
law solved for e is a low pass of the force, e + (kp / ki) de/dt = u / ki. What is left of e beyond that is a departure.
"""

from __future__ import annotations

from collections.abc import Sequence

from sher3_common.reasons import Reason, reading
from sher3_common.vectors import Vector

from sher3_drivers.canopen.tpdo import DriveFeedback
from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.trips import Trip


class AxisPosition:
    """The sum of one axis.

    Attributes:
        left: how far it is from the sum of its commands since the beginning, by the encoder that says less, m or rad.
        explained: how much of that its force explains, at most `position_elastic`, m or rad.
        limit: largest departure at the newest speeds and force, m or rad.
    """

    __slots__ = (
        "_base", "_by_motor", "_elastic", "_force", "_keep", "_lag", "_load", "_motor", "_name", "_path", "_peak",
        "_plain", "_scale", "_share", "_time", "explained", "left", "limit",
    )  # fmt: skip

    def __init__(self, scale: AxisScale, settings: MotorDriverSettings) -> None:
        self._scale, self._name = scale, scale.name
        self._plain = settings.position_angle if scale.revolute else settings.position_distance
        self._elastic = settings.elastic_angle if scale.revolute else settings.elastic_distance
        self._lag, self._share = settings.position_lag, settings.position_force
        self._time = scale.settling
        self._keep = 1.0 - min(1.0, settings.period / settings.following_memory)
        self.begin(0.0, 0.0, 0.0)

    def begin(self, motor: float, load: float, effort: float) -> None:
        """Take these readings as the beginning; the force `effort` [N, N m] is what holds the axis there."""
        self._motor, self._load, self._path, self._peak = motor, load, 0.0, 0.0
        self._base = self._force = effort / self._scale.hold
        self.left = self.explained = self._by_motor = 0.0
        self.limit = self._plain

    def advance(self, motor: float, load: float, effort: float, command: float, since: float) -> None:
        """Add the `command` [m/s, rad/s] that held for `since` s, and take the readings after it."""
        self._path += command * since
        self._by_motor, by_load = self._path + self._motor - motor, self._path + self._load - load
        self.left = by_load if abs(by_load) < abs(self._by_motor) else self._by_motor
        self._force += min(1.0, since / self._time) * (effort / self._scale.hold - self._force)
        self.explained = max(-self._elastic, min(self._elastic, self._force - self._base))
        self._peak = max(abs(command), self._keep * self._peak)
        self.limit = self._plain + self._lag * self._peak + self._share * abs(self.explained)

    @property
    def departure(self) -> float:
        """How far the axis is from where commands and force put it, m or rad."""
        return self.left - self.explained

    @property
    def moved(self) -> float:
        """The same of an axis at rest, by its motor: a load encoder that comes back to life has moved nothing.

        Its drive may hold it or not, as without power, so the force counts only where it explains something.
        """
        return min(self._by_motor, self._by_motor - self.explained, key=abs)

    def reading(self) -> tuple[str, str]:
        """Return what is looked at now, with its limit, for the diagnostics."""
        return reading(Reason.POSITION_LEFT, self._name, abs(self.departure), self.limit, self._scale.unit)


class PositionWatch:
    """The sums of the five axes.

    Attributes:
        axes: one per actuator, in the order of ACTUATORS.
    """

    def __init__(self, scales: Sequence[AxisScale], settings: MotorDriverSettings) -> None:
        self._scales = tuple(scales)
        self.axes = [AxisPosition(scale, settings) for scale in scales]
        self._begun = False

    def begin(self) -> None:
        """Begin at the next feedback."""
        self._begun = False

    def follow(self, feedback: DriveFeedback, held: Vector, since: float) -> None:
        """Take a feedback and the commands (5,) [m/s, rad/s] held over the `since` s before it."""
        readings = zip(feedback.motor_position, feedback.load_position, feedback.effort, strict=True)
        for axis, encoders_and_force, command in zip(self.axes, readings, held, strict=True):
            if self._begun:
                axis.advance(*encoders_and_force, command, since)
            else:
                axis.begin(*encoders_and_force)
        self._begun = True

    def judge(self) -> Trip | None:
        """Object to an axis that is not where its commands put it; whoever is halfway there is suspected too."""
        for axis, scale in zip(self.axes, self._scales, strict=True):
            value = abs(axis.departure)
            if value > axis.limit:
                text = (
                    f"{scale.name}: {value:.3g} {scale.unit} from where its commands add up to (limit {axis.limit:.3g})"
                )
                suspects = tuple([n for n, a in enumerate(self.axes) if abs(a.departure) > 0.5 * a.limit])
                return Trip(Reason.POSITION_LEFT, text, value, axis.limit, scale.unit, suspects)
        return None

    @property
    def moved(self) -> Vector:
        """How far the axes are from where they were at the beginning, commands and force aside (5,) [m, rad]."""
        return tuple([axis.moved for axis in self.axes])
