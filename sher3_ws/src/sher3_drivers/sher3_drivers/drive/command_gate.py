"""Which velocity command may pass to the drives, and how old the newest one is.

The last gate before the drives' own: it lets five finite numbers within the velocity limits pass, of this tick or of
one nearby. When commands stay away it asks first for zero velocity and then for a stop.
"""

from __future__ import annotations

from collections.abc import Sequence

from sher3_common.reasons import Reason
from sher3_common.vectors import Vector

from sher3_drivers.errors import CommandRefused
from sher3_drivers.settings import MotorDriverSettings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.trips import Trip

_ROUNDING = 1e-9
"""Relative excess over a velocity limit that passes: the sender's own limit, computed in another order, rounds so."""


class CommandGate:
    """The gate of `MotorDriver.command`.

    Attributes:
        stamp: the present tick, ns.
        caps: largest speeds that pass (5,) [m/s, rad/s].
        following: whether the drives have been following commands since they were enabled.
    """

    def __init__(self, scales: Sequence[AxisScale], settings: MotorDriverSettings) -> None:
        self.stamp = 0
        self.following = False
        self.caps: Vector = tuple([scale.velocity_limit for scale in scales])
        self._scales, self._settings = tuple(scales), settings
        self._period_ns = round(settings.period * 1e9)
        self._zero_ns = settings.zero_age * self._period_ns
        self._newest = 0
        self._refused_last = False
        self._early: tuple[int, list[int]] | None = None

    @property
    def age(self) -> int:
        """Ticks' time since the newest command went to the drives, ns."""
        return self.stamp - self._newest

    @property
    def late(self) -> bool:
        """Whether the newest command is so old that zero velocity must be sent."""
        return self.stamp - self._newest >= self._zero_ns

    def begin(self) -> None:
        """Wait for drives that are being enabled: the age of commands counts from the tick in which they are."""
        self.following = False

    def check(self, stamp: int, velocity: Sequence[float]) -> list[int]:
        """Return a velocity command (5,) [m/s, rad/s] of tick `stamp` in the drives' counts.

        Raises:
            CommandRefused: not five finite values within the velocity limits, or not of this or a near tick.
        """
        age = self.stamp - stamp
        if not abs(age) < self._zero_ns:
            limit = f"less than {self._settings.zero_age * self._settings.period * 1e3:g} ms either way"
            what = "age of the command"
            raise CommandRefused(what, value=f"{age * 1e-6:g} ms", limit=limit, remedy="check its sender")
        return velocity_counts(self._scales, velocity, self.caps)

    def refuse(self) -> None:
        """Note that a command was refused; one that waits for its tick is forgotten too."""
        self._refused_last, self._early = True, None

    def keep(self, stamp: int, counts: list[int]) -> None:
        """Keep a command whose tick is still to come, in counts."""
        self._early = stamp, counts

    def take_due(self) -> list[int] | None:
        """Return the kept command once its tick has come, and forget it; None when there is none."""
        if self._early is None or self._early[0] > self.stamp:
            return None
        (_, counts), self._early = self._early, None
        return counts

    def forget(self) -> None:
        """Forget a command that waits for its tick: the robot stops."""
        self._early = None

    def passed(self) -> None:
        """Note that a command goes to the drives in this tick."""
        self._newest, self._refused_last = self.stamp, False

    def watch(self) -> Trip | None:
        """Judge the age of the newest command to enabled drives; object when it reaches `stop_age` periods."""
        if not self.following:
            self.following = True
            self._newest = self.stamp
        ticks, limit = (self.stamp - self._newest) // self._period_ns, self._settings.stop_age
        if ticks < limit:
            return None
        reason = Reason.COMMAND_REFUSED if self._refused_last else Reason.COMMAND_STALE
        return Trip(reason, f"no command for {ticks} ticks (limit {limit})", ticks, limit, "ticks")


def velocity_counts(scales: Sequence[AxisScale], velocity: Sequence[float], caps: Vector) -> list[int]:
    """Return a velocity command (5,) [m/s, rad/s] within `caps` (5,) in the drives' counts.

    Raises:
        CommandRefused: not five values, not finite, or beyond a cap.
    """
    if len(velocity) != len(scales):
        what = "number of velocities"
        raise CommandRefused(what, value=len(velocity), limit=len(scales), remedy="send five")
    counts = []
    for scale, value, cap in zip(scales, velocity, caps, strict=True):
        if not abs(value) <= cap * (1.0 + _ROUNDING):  # a NaN compares false
            what, remedy = f"{scale.name}: velocity command", "limit it at its source"
            raise CommandRefused(what, value=value, limit=cap, remedy=remedy)
        # A value within the limit fits its object: `AxisScale` has made sure of that.
        counts.append(round(value / scale.velocity))
    return counts
