"""The signals of all joints of a run side by side, on the side of the motors where a transmission couples them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_effects.operators import second_difference

from sher3_chain.joint.record import AxesRun
from sher3_chain.manipulator.description import ManipulatorDescription
from sher3_chain.readings.cut_off import cut_off
from sher3_chain.readings.signals import AxisSignals, signals_of

FINEST = 5
"""Moments of a row at most at which a friction that turns is looked at."""


@dataclass(frozen=True)
class JointSignals(AxisSignals):
    """Signals of one axis, with a column for each joint; `load` is NaN where a joint has no second encoder.

    Attributes:
        steps: of the loop that moves the joints in a row of the log, where forces hold from row to row; 1 where they go
            on between rows.
        within: (k,) force that a servo gives within a row beside what its rows say, rms, N or N m; None: none.
    """

    UNSTATED: ClassVar[float] = 0.0

    steps: float = 1.0
    within: Array | None = None

    @cached_property
    def velocity(self) -> Array:
        """Velocity from the smoothed position, (n, k)."""
        return self.speed_of(self.smooth)

    @cached_property
    def acceleration(self) -> Array:
        """Acceleration of the position at each row, not smoothed, (n, k)."""
        return self.at_rows(second_difference(self.motor, self.period))

    def speed_of(self, x: Array) -> Array:
        """Return the speed of places (n, k) at each row.

        A central difference is the mean of a speed over two rows, x + x'' T^2 / 6 of it.
        """
        mean = np.gradient(x, self.period, axis=0)
        return mean - (1.0 - self.steps**-2) / 6.0 * second_difference(mean, 1.0)

    def over_rows(self, force: Callable[[float], Array]) -> Array:
        """Return a force (n, k) that turns within a row, at each row.

        Args:
            force: (n, k) so many seconds after each row.
        """
        n = min(round(self.steps), FINEST)
        if n == 1:
            return force(0.0)
        each = [(n - abs(i)) / n**2 * force(i / n * self.period) for i in range(1 - n, n)]
        return self.at_rows(np.sum(each, axis=0))

    def at_rows(self, mean: Array) -> Array:
        """Return what acts (n, ...) at each row, of a mean over the steps of the rows before and behind.

        They weigh as a triangle, x + x'' T^2 / 12 of what goes on evenly, as a second difference weighs accelerations.
        """
        return np.asarray(mean - (1.0 - self.steps**-2) / 12.0 * second_difference(mean, 1.0))


def joint_signals(run: AxesRun, described: ManipulatorDescription, excitation: str) -> JointSignals:
    """Return the signals of a run, (n, k).

    Args:
        run: the record.
        described: the arm.
        excitation: the name that repeats of the run share.
    """
    each = [signals_of(run, joint, excitation) for joint in described.joints]
    travel = np.asarray(described.coupling if described.coupling is not None else np.eye(len(each)))
    own = np.eye(len(each))
    force = np.linalg.inv(travel) if described.effort_of == "joints" else own
    place = travel if described.position_of == "joints" else own
    effort = np.hstack([_gained(one, joint.gain) for one, joint in zip(each, described.joints, strict=True)])
    return JointSignals(
        name=run.name,
        excitation=excitation,
        period=run.period,
        motor=np.hstack([one.motor for one in each]) @ place.T,
        effort=effort @ force,
        reference=_beside([one.reference for one in each], each[0].motor, np.eye(len(each))),
        load=_beside([one.load for one in each], each[0].motor, travel),
        bandwidth=min(cut_off(one.motor[:, 0], run.period, one.bandwidth) for one in each),
    )


def _gained(one: AxisSignals, gain: float | str) -> Array:
    if one.effort is None:
        return np.zeros_like(one.motor)  # the joint is not judged
    return one.effort * gain if isinstance(gain, float) else one.effort


def _beside(found: Sequence[Array | None], like: Array, travel: Array) -> Array | None:
    """Return positions (n, k) on the side of the motors, NaN where there is none; None without any."""
    if not any(x is not None for x in found):
        return None
    side = np.hstack([np.full_like(like, np.nan) if x is None else x for x in found])
    return side if np.array_equal(travel, np.eye(len(found))) else side @ travel.T
