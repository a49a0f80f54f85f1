"""The motion of a run, low-passed and sampled on the residual grid: what every machine with axes has in common."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sher3_diagnosis.channel import Array, Mask
from sher3_diagnosis.filter import BANDWIDTH, DECIMATED_RATE, EDGE, SHORT, low_pass

from sher3_effects.operators import second_difference


class FilteredRun:
    """Signals of a run on its ticks, (n, axes) in SI units; see `sher3_diagnosis.filter` for the residual grid.

    A machine adds `stage_clock` (n,), s, and what was recorded besides: `effort`, `reference`, `command`, `echo` and
    `load`, None where it was not.

    Attributes:
        period: of the ticks, s.
        motor: position of the motors' encoders, (n, axes).
        bandwidth: cut-off of the low-pass, Hz.
    """

    period: float
    motor: Array
    bandwidth: float = BANDWIDTH

    @property
    def ticks(self) -> int:
        """Number of ticks."""
        return len(self.motor)

    @cached_property
    def stride(self) -> int:
        """Ticks per sample of the residual grid: 2.5 samples per period of the cut-off."""
        if self.ticks < SHORT:
            return 1
        return max(1, round(BANDWIDTH / self.bandwidth / (DECIMATED_RATE * self.period)))

    @property
    def rate(self) -> float:
        """Samples per second of the residual grid, Hz."""
        return 1.0 / (self.stride * self.period)

    @cached_property
    def grid(self) -> NDArray[np.int64]:
        """Ticks of the residual grid, (g,)."""
        return np.arange(0, self.ticks, self.stride)

    @property
    def edge(self) -> float:
        """Ticks at each end of the run, and at each side of a step, that the filter spoils."""
        short = self.ticks < SHORT  # too short for the filter: only the differences lose their ends
        return 2.0 if short else EDGE * BANDWIDTH / self.bandwidth / self.period

    @cached_property
    def inner(self) -> Mask:
        """(g,) False where the ends of the filter spoil a sample."""
        return self.between_ends()

    def between_ends(self) -> Mask:
        """Return (g,) False within `edge` of either end."""
        return (self.grid >= self.edge) & (self.grid < self.ticks - self.edge)

    @cached_property
    def smooth(self) -> Array:
        """Motor position after the low-pass, (n, axes)."""
        return self.filtered(self.motor)

    @cached_property
    def velocity(self) -> Array:
        """Motor velocity from the smoothed position, (n, axes)."""
        return np.gradient(self.smooth, self.period, axis=0)

    @cached_property
    def acceleration(self) -> Array:
        """Second difference of the motor position, not smoothed, (n, axes)."""
        return second_difference(self.motor, self.period)

    def filtered(self, x: Array) -> Array:
        """Return an (n, ...) signal after the low-pass; n may differ from the run's."""
        return low_pass(x, self.period, self.bandwidth)

    def to_grid(self, x: Array) -> Array:
        """Low-pass an (n, ...) signal and sample it on the residual grid -> (g, ...)."""
        return self.filtered(x)[self.grid]


class GridView:
    """A run as the engine sees it.

    Attributes:
        run: its signals, a `FilteredRun` with what was recorded besides.
        holds_at_rest: whether a dry friction holds any force up to its level in samples at rest.
    """

    run: Any
    holds_at_rest = False

    @cached_property
    def position(self) -> Array:
        """Smoothed motor position on the residual grid, (g, axes)."""
        return self.run.smooth[self.run.grid]

    @cached_property
    def velocity(self) -> Array:
        """Motor velocity on the residual grid, (g, axes)."""
        return self.run.velocity[self.run.grid]

    @cached_property
    def acceleration(self) -> Array:
        """Motor acceleration on the residual grid, (g, axes)."""
        return self.run.to_grid(self.run.acceleration)

    @property
    def excitation(self) -> str:
        """Name that repeats of the run share."""
        return self.run.excitation

    @property
    def temperature_known(self) -> bool:
        """Whether the temperature was recorded."""
        return self.run.temperature is not None

    @property
    def step(self) -> float:
        """Time between two ticks, s."""
        return self.run.period

    def quantities(self, site: str) -> dict[str, Array]:
        """Return quantity, of `sher3_diagnosis.effect.INPUTS`, -> (g, k) columns, as a place feels them.

        Raises:
            NotImplementedError: here; each kind of machine says its own.
        """
        raise NotImplementedError

    def inputs(self, actuator: str) -> Array:
        """Return (g, k) all of them side by side."""
        return np.hstack([*self.quantities(actuator).values()])

    def at_residuals(self, x: Array) -> Array:
        """Low-pass values (ticks, ...) and sample them on the residual grid, (g, ...)."""
        return self.run.to_grid(x)
