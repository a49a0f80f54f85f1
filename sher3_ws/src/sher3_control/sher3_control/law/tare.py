"""Tare of the force sensor: a bias from a window of samples at rest, or a refusal; and a watch on later drift."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sher3_common.stamps import seconds
from sher3_common.vectors import Vector, Wrench
from sher3_description import Robot

from sher3_control.errors import TareRefused
from sher3_control.law.tool_compensation import tip_rotation, tool_gravity
from sher3_control.settings import TareSettings

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TareResult:
    """A new bias and how good it is; wrenches (6,) in {f} [N], [N m].

    Attributes:
        bias: mean of the raw wrench less the tool's weight.
        change: new bias less the former one.
        residual: standard error of the mean, by which the bias may still be off.
        samples: length of the window.
    """

    bias: Wrench
    change: Wrench
    residual: Wrench
    samples: int


class TareWindow:
    """The newest samples. The node feeds it at every tick; only a tare judges them.

    Args:
        robot: for the sensor's range and noise, the tool and the travel of the actuators.
        settings: length of the window and limits.
    """

    def __init__(self, robot: Robot, settings: TareSettings) -> None:
        self._settings = settings
        self._samples: deque[tuple[int, Wrench, Vector, float, float]] = deque(maxlen=settings.samples)
        sensor = robot.force_sensor
        self._mass, self._com = float(sensor.tool_mass), sensor.tool_com
        # A sensor without noise still flickers by its resolution.
        noise = max(sensor.noise_force, sensor.resolution_force), max(sensor.noise_torque, sensor.resolution_torque)
        self._noise = settings.noise_factor * np.repeat(noise, 3)
        self._largest = settings.residual * np.array(sensor.range_force + sensor.range_torque)
        self._still = settings.still * np.array([a.limits.upper - a.limits.lower for a in robot.actuators])

    def feed(self, stamp: int, wrench: Wrench, q: Vector, roll: float, tilt: float) -> None:
        """Take a raw wrench, the actuator positions and the two angles [rad] of the same tick."""
        self._samples.append((stamp, wrench, q, roll, tilt))

    def tare(self, pressed: bool, now: int, age_limit: int, former: Wrench) -> TareResult:
        """Return a new bias.

        Args:
            pressed: the pedal is not released.
            now: time of the request [ns].
            age_limit: the newest sample may be this old [ns].
            former: the bias in force.

        Raises:
            TareRefused: the pedal is pressed, samples are too few, too old or faulty, the robot moved, the wrench was
                noisy, or the mean is too large for a bias.
        """
        if pressed:
            raise TareRefused("pressed", "the pedal is not released", remedy="release the pedal")
        wrenches, joints, weights = self._columns(now, age_limit)
        self._require_rest(wrenches, joints)
        bias = (wrenches - weights).mean(axis=0)
        over = np.abs(bias) / self._largest
        if over.max() > 1.0:
            k = int(over.argmax())
            what, remedy = f"bias of axis {k} too large", "unload the tool; if it is unloaded, check the sensor"
            raise TareRefused("too_large", what, value=float(bias[k]), limit=float(self._largest[k]), remedy=remedy)
        error = wrenches.std(axis=0, ddof=1) / np.sqrt(len(wrenches))
        return TareResult(_wrench(bias), _wrench(bias - former), _wrench(error), len(wrenches))

    def _columns(self, now: int, age_limit: int) -> tuple[Array, Array, Array]:
        """Return wrenches (n, 6), joint positions (n, 5) and weights of the tool (n, 6); raises TareRefused."""
        count, needed = len(self._samples), self._settings.samples
        if count < needed:
            raise TareRefused("samples", "too few samples", value=count, limit=needed, remedy="wait and try again")
        age = now - self._samples[-1][0]
        if age > age_limit:
            what = "the newest sample is too old [s]"
            raise TareRefused("samples", what, value=seconds(age), limit=seconds(age_limit), remedy="check the sensor")
        weights = [tool_gravity(tip_rotation(s[3], s[4]), self._mass, self._com) for s in self._samples]
        wrenches = np.array([s[1] for s in self._samples])
        return wrenches, np.array([s[2] for s in self._samples]), np.array(weights)

    def _require_rest(self, wrenches: Array, joints: Array) -> None:
        """Raise TareRefused unless the samples are finite and alive, the robot rested and nobody touched the tool."""
        if not (np.isfinite(wrenches).all() and np.isfinite(joints).all()):
            raise TareRefused("faulty", "samples hold NaN or infinity", remedy="check the sensor")
        if (np.ptp(wrenches, axis=0) == 0.0).all():
            raise TareRefused("faulty", "all samples are identical: the sensor is frozen", remedy="check the sensor")
        span = np.ptp(joints, axis=0) / self._still
        if span.max() > 1.0:
            k = int(span.argmax())
            value, limit = float(np.ptp(joints[:, k])), float(self._still[k])
            raise TareRefused("moving", f"axis {k} moved", value=value, limit=limit, remedy="let the robot rest")
        noise = wrenches.std(axis=0) / self._noise
        if noise.max() > 1.0:
            k = int(noise.argmax())
            value, limit = float(wrenches[:, k].std()), float(self._noise[k])
            raise TareRefused("noisy", f"axis {k} is noisy", value=value, limit=limit, remedy="do not touch the tool")


class DriftMonitor:
    """Mean contact wrench while nothing should touch the tool: the error of bias and weight.

    Args:
        settings: limits of the drift.
        period: of the ticks [s].
        time_constant: of the low-pass [s].
    """

    def __init__(self, settings: TareSettings, period: float, time_constant: float = 1.0) -> None:
        self._weight = period / time_constant
        self._limit = np.repeat((settings.drift_force, settings.drift_torque), 3)
        self._mean: Array = np.zeros(6)
        self._count = 0

    @property
    def drift(self) -> Wrench | None:
        """The drift (6,) in {t} [N], [N m]; None until the robot has rested for a time constant."""
        return _wrench(self._mean) if self._count * self._weight >= 1.0 else None

    def feed(self, wrench: Wrench) -> None:
        """Take the contact wrench of a tick at rest with the pedal released."""
        self._count += 1
        # The plain mean at first, so that the first sample does not weigh more than the others.
        self._mean += max(self._weight, 1.0 / self._count) * (np.array(wrench) - self._mean)

    def exceeded(self) -> bool:
        """Return whether the drift is known and beyond its limits in any axis."""
        return self.drift is not None and bool((np.abs(self._mean) > self._limit).any())

    def reset(self) -> None:
        """Start again, after a tare or a motion."""
        self._mean, self._count = np.zeros(6), 0


def _wrench(values: Array) -> Wrench:
    a, b, c, d, e, f = values.tolist()
    return a, b, c, d, e, f
