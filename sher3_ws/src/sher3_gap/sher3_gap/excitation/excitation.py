"""An excitation: the set-points of one run and its known tip loads, checked against the robot's limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_bags import RunMetadata
from sher3_common import Sher3Error
from sher3_description import ACTUATORS, Robot

from sher3_gap.excitation.profile import FloatArray

Load = tuple[float, float, float, float, float]

RAMP = 0.08
"""Seconds over which a tip load rises before its plateau and falls after it."""


class ExcitationError(Sher3Error):
    """An excitation is unknown or leaves the limits; carries `excitation` and, where one is meant, `actuator`."""

    def __init__(self, what: str, *, excitation: str, actuator: str | None = None, **details: object) -> None:
        super().__init__(f"{excitation}{f' on {actuator}' if actuator else ''}: {what}", **details)  # type: ignore[arg-type]
        self.excitation = excitation
        self.actuator = actuator


@dataclass(frozen=True, eq=False)
class Excitation:
    """Set-points of one run.

    Attributes:
        name: name in the catalogue, without the amplitude.
        amplitude: scale of the motion or of the loads, 1 is the catalogue's.
        posture: name of the posture at which it starts.
        period: control period [s].
        position: (n, 5) set-point per tick, actuator units.
        velocity: (n, 5) set-point velocity per tick.
        loads: known tip loads, rows (from [s], to [s], Fx, Fy, Fz [N in {b}]), constant between from and to.
    """

    name: str
    amplitude: float
    posture: str
    period: float
    position: FloatArray
    velocity: FloatArray
    loads: tuple[Load, ...] = ()

    @property
    def label(self) -> str:
        """The name as it stands in the run's metadata: `sweep`, or `sweep_0.8` at another amplitude."""
        return self.name if self.amplitude == 1.0 else f"{self.name}_{self.amplitude:g}"

    @property
    def time(self) -> FloatArray:
        """(n,) seconds since the first tick."""
        return np.arange(len(self.position)) * self.period

    def contact_wrench(self) -> FloatArray:
        """Return (n, 6) the wrench at the tip in {b} that the loads mean, with linear ramps outside the plateaus."""
        wrench = np.zeros((len(self.position), 6))
        for start, end, *force in self.loads:
            rise = (self.time - (start - RAMP)) / RAMP
            fall = ((end + RAMP) - self.time) / RAMP
            wrench[:, :3] += np.clip(np.minimum(rise, fall), 0.0, 1.0)[:, None] * np.asarray(force)
        return wrench

    def metadata(self, repeat: int, *, origin: str = "plant", seed: int | None = None) -> RunMetadata:
        """Return the `sher3.run` record of one repeat."""
        return RunMetadata(self.label, repeat, self.amplitude, self.loads, self.posture, origin, seed)


def check_limits(excitation: Excitation, robot: Robot, *, jumps: bool = False) -> Excitation:
    """Return the excitation unchanged if its set-points keep the robot's limits.

    Args:
        excitation: what to check.
        robot: whose limits hold.
        jumps: allow set-points that jump; then only the position and the demand they cause are checked.

    Raises:
        ExcitationError: the first actuator that leaves its position, velocity or acceleration limit.
    """
    gain = robot.position_gain
    for j, (name, actuator) in enumerate(zip(ACTUATORS, robot.actuators, strict=True)):
        q, v, limits = excitation.position[:, j], excitation.velocity[:, j], actuator.limits
        step = np.abs(np.diff(q))
        demand = gain * step.max(initial=0.0) if jumps else 0.0
        acceleration = 0.0 if jumps else np.abs(np.diff(v)).max(initial=0.0) / excitation.period
        checks: Sequence[tuple[str, float, float]] = (
            ("position above the lower limit", float(limits.lower - q.min()), 0.0),
            ("position below the upper limit", float(q.max() - limits.upper), 0.0),
            ("velocity", max(float(np.abs(v).max()), float(demand)), limits.velocity),
            ("acceleration", float(acceleration), limits.acceleration),
        )
        for what, value, limit in checks:
            if value > limit * (1 + 1e-9):
                raise ExcitationError(
                    f"{what} is not kept",
                    excitation=excitation.label,
                    actuator=name,
                    value=value,
                    limit=limit,
                    remedy="reduce the amplitude",
                )
    return excitation
