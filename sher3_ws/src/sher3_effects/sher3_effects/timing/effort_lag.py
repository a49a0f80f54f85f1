"""Drive lag behind a recorded effort: what acts on the axis comes later than what was recorded of its drive."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Shape, Signature, column

from sher3_effects.delay import LONGEST_DELAY, earliest, shifted
from sher3_effects.operators import lagged
from sher3_effects.timing.drive_lag import DriveLag
from sher3_effects.view import AxisView


class EffortLag(DriveLag):
    """A force that follows the recorded effort through a filter of first order, or a dead time later.

    A voltage, a duty or a valve is recorded; a propeller, a coil or a chamber that fills comes between it and the axis.
    A recorded force acts at once. The mass was identified behind one such lag: what another one changes of it is free.
    """

    kinds, needs = ("axis",), ("drive",)
    seen_at = (("motor_mechanics", ""),)
    plain = after_effort = True
    gives = ()
    on_axis = {"time_constant": "lag", "delay": "delay"}
    leaves_out = "what lies between drive and axis beside a lag"
    explanation = "The force on the axis follows what was recorded of its drive late, like a filter or a dead time."
    siblings = {
        "sensor_delay": "the reading of the effort is late, not the force",
        "viscous_friction": "grows with the speed, and not with the slope of the effort",
    }
    units = {"time_constant": "s", "delay": "s"}
    LEAST, UNSEEN = 2.0, 0.1
    """Shortest time that is tried, in periods of the record and of the cut-off: less is the moment of a reading."""
    STEP = 1.6
    """Ratio of two times that are tried, up to the longest delay."""
    HEAVIER = 0.4
    """Share by which the mass may change at most beside another lag."""
    finer: ClassVar[Mapping[str, tuple[float, ...]]] = {
        name: (0.8, 0.9, 0.95, 1.05, 1.1, 1.25) for name in ("time_constant", "delay")
    }

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return time constants, s, and dead times beyond what a filter of the position makes."""
        run, row = views[0].run, views[0].row(site)
        if run.effort is None or not np.any(run.effort[:, row]) or not views[0].axis(site).effort_is_demand:
            return []
        late, times = earliest(run.period), self.times(run.period, run.bandwidth)
        return [*({"time_constant": t} for t in times), *({"delay": t} for t in times if t > late)]

    def times(self, period: float, bandwidth: float) -> list[float]:
        """Return the times that are tried in a record of a period, s, and a cut-off, Hz."""
        least = max(self.LEAST * period, self.UNSEEN / bandwidth)
        count = int(np.log(LONGEST_DELAY / least) / np.log(self.STEP)) + 1 if least < LONGEST_DELAY else 0
        return [float(least * self.STEP**k) for k in range(count)]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return the recorded effort less the effort that acts, and the force on the mass."""
        run = view.run
        assert run.effort is not None
        given = run.effort[:, view.row(site)]
        acting = self.acting(given, run.stage_clock, run.period, shape)
        channel = Channel("motor_mechanics", site)
        inertia = view.axis(site).mass * view.acceleration[:, view.row(site)]
        heavier = {channel: column(inertia)} if inertia.any() else {}
        return Signature(heavier, {channel: run.to_grid((given - acting)[:, None])})

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the mass, off by a share (p,), is about the identified: a lag and a mass may change places."""
        return all(abs(share) < self.HEAVIER for share in coefficients)

    def acting(self, given: Array, clock: Array, period: float, shape: Shape) -> Array:
        """Return the force (n,) that follows a recorded one in a shape."""
        if "delay" in shape:
            return shifted(given, clock, shape["delay"])
        return lagged(given, shape["time_constant"], period)
