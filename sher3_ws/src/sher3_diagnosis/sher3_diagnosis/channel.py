"""Residual channels: where in the signal chain a difference between a machine and its model is measured.

The residual of a channel is the measured output of a stage minus the nominal prediction from the *measured* input of
that stage. A gap upstream therefore does not leak downstream (conditional predictors).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

STAGES = ("transport", "controller", "drive", "motor_mechanics", "transmission", "mechanism", "structure", "sensing")
"""Stages in the order of the signal chain: a gap upstream is explained first."""
AT_TIP = ("mechanism", "structure")
"""Stages that are seen at the tip, by one reading of its pose."""


class Channel(NamedTuple):
    """A stage at an actuator, or at another place of the machine such as its tip; a tuple is looked up fast."""

    stage: str
    actuator: str

    def __str__(self) -> str:
        return f"{self.stage}/{self.actuator}"


@dataclass(frozen=True)
class Residual:
    """Residual of one channel in one run, on a grid of g samples that are close to independent.

    Attributes:
        values: (g, d) in SI units, d components.
        ok: (g,) True for samples that count.
        free_mean: share of each run's mean that is not the machine's and is taken off before anything is compared.
            1 where the start of an integrator is not recorded. A share below 1 is the quasi-demeaning of a random
            intercept: two encoders' zeros differ from run to run, and the share that stays weighs that spread.
        determined: (g, d, d) what each sample tells of its components, where a part of the input is unknown: a
            projection that takes the unknown part off. None where all of every sample counts.
    """

    values: Array
    ok: Mask
    free_mean: float = 0.0
    determined: Array | None = None

    @cached_property
    def counting(self) -> NDArray[np.int64]:
        """Indices (k,) of the samples that count: taking them is some ten times as fast as a mask."""
        return np.flatnonzero(self.ok)

    def rms(self) -> Array:
        """Root mean square over the samples that count, (d,)."""
        if not self.ok.any():
            return np.zeros(self.values.shape[1])
        return np.sqrt(np.mean(self.values[self.ok] ** 2, axis=0))

    def relieved(self, values: Array, at: Mask | None = None) -> Array:
        """Subtract the free share of the mean, and undetermined components, from (n, ...) values of one run.

        Args:
            values: at the samples of a mask.
            at: the mask, as long as the shortest run compared; default the samples that count.
        """
        if self.determined is not None:
            at = self.ok if at is None else at
            values = np.einsum("gij,gj...->gi...", self.determined[: len(at)][at], values)
        return self.centred(values)

    def centred(self, values: Array) -> Array:
        """Subtract the free share of the mean from (n, ...) values of one run."""
        return values - self.free_mean * (values.sum(axis=0) / len(values)) if self.free_mean else values

    def wholly_determined(self) -> Residual:
        """Return the residual with only those samples that determine all of their components."""
        if self.determined is None:
            return self
        whole = np.all(self.determined == np.eye(self.values.shape[1]), axis=(1, 2))
        return Residual(self.values, self.ok & whole, self.free_mean)

    @property
    def partly_free(self) -> bool:
        """Whether a share of the mean is free, but not all of it."""
        return 0.0 < self.free_mean < 1.0

    def restored(self, values: Array) -> Array:
        """Add to values (n, ...) the mean that `relieved` took off, where a share of it was left that tells it."""
        if not self.partly_free:
            return values
        return values + self.free_mean / (1.0 - self.free_mean) * values.mean(axis=0)


Residuals = dict[Channel, Residual]
"""Residuals of one run."""
Floors = dict[Channel, Array]
"""Standard deviation of the floor per channel, (d,): what two runs of the same machine differ by."""
