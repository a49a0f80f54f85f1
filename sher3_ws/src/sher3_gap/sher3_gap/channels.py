"""Residual channels: where in the signal chain a difference between robot and simulation is measured.

A channel is one stage at one actuator (or `tip`, `force_sensor`). Its residual is measured output minus the
nominal prediction
from the *measured* input of that stage, so that an upstream gap does not leak downstream (gap-diagnosis:
conditional predictors).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STAGES = ("transport", "controller", "drive", "motor_mechanics", "transmission", "mechanism", "structure", "sensing")
"""Stages in the order of the signal chain: an upstream gap is explained first."""


@dataclass(frozen=True, order=True)
class Channel:
    """A stage at an actuator."""

    stage: str
    actuator: str

    def __str__(self) -> str:
        return f"{self.stage}/{self.actuator}"


@dataclass(frozen=True)
class Residual:
    """Residual of one channel in one run on the residual grid.

    Attributes:
        values: (g, d) in SI units.
        ok: (g,) samples that count.
    """

    values: Array
    ok: NDArray[np.bool_]

    def rms(self) -> Array:
        """Root mean square over the samples that count, (d,)."""
        if not self.ok.any():
            return np.zeros(self.values.shape[1])
        return np.sqrt(np.mean(self.values[self.ok] ** 2, axis=0))


FREE_MEAN = {"drive": 1.0, "transmission": 0.96}
"""Share of each run's mean that a stage's residual is relieved of, because part of it is not the robot's.

Where the drive's integrator started is not recorded. The zeros of two encoders differ by a share of a count from run
to run: the share that remains weighs a run's mean against that spread (quasi-demeaning of a random intercept).
"""


def relieved(channel: Channel, values: Array) -> Array:
    """Take the free share of the mean off (n, ...) values of one run."""
    share = FREE_MEAN.get(channel.stage, 0.0)
    return values - share * values.mean(axis=0) if share else values


def partly_free(channel: Channel) -> bool:
    """Whether a run's mean is relieved of a share and not of all of it."""
    return 0.0 < FREE_MEAN.get(channel.stage, 0.0) < 1.0


def restored(channel: Channel, values: Array) -> Array:
    """Put back what `relieved` took off, where anything remains to tell it."""
    share = FREE_MEAN.get(channel.stage, 0.0)
    return values + share / (1.0 - share) * values.mean(axis=0) if partly_free(channel) else values


UNITS = {
    "transport": "m/s",
    "controller": "m/s",
    "drive": "N",
    "motor_mechanics": "N",
    "transmission": "m",
    "mechanism": "m",
    "structure": "m",
    "sensing": "N",
}


def unit_of(channel: Channel) -> str:
    """Unit of the first component of a channel; the roll axis is rotary."""
    unit = UNITS[channel.stage]
    if channel.actuator != "roll":
        return unit
    return {"m/s": "rad/s", "N": "N*m", "m": "rad"}[unit]
