"""A recorded run as the diagnosis sees it: aligned arrays on the tick grid, smoothed motion, known contact load.

Everything downstream (residuals, effects) reads a `RunSignals`; nothing downstream opens a bag. The residuals live on
a coarser grid: see `sher3_diagnosis.filter`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from sher3_diagnosis.channel import Array
from sher3_effects.motion import FilteredRun

RAMP_LIMIT = 0.25
"""Longest time from an unloaded tip to a stated plateau over which the load is taken as unknown, s."""


@dataclass(frozen=True)
class RunSignals(FilteredRun):
    """Signals of one run; (n, axes) float64 in SI units, None where the stream was not recorded.

    Attributes:
        name: bag name; `excitation`, `repeat`: from the case.
        period: tick period, s.
        stage_clock: (n,) s since the first tick.
        reference, reference_velocity: `setpoint_js`.
        command: `servo_jv` velocity.
        echo: `drives/setpoint_jv` velocity.
        motor, effort: motor encoder position and reported effort; `load`: load encoder position.
        wrench: (n, 6) force sensor reading in {f}.
        tracker_index: (m,) tick of each tracker sample; `tracker_position` (m, 3), `tracker_rotation` (m, 4) x y z w.
        contact: (n, 3) known force on the tip in {b}, N; `contact_known`: (n,) False where it is not known
            (load ramps).
        temperature: (n,) deg C; `session_time`: s from the first run's start to this one's.
        payload: known tip loads as recorded; `start`: first stamp, ns.
        lost: (n,) True where a tick was not recorded and is bridged; `stale`: where the host computed with an earlier
            reading; `held`: where the drives held an earlier demand for once. None: no such tick.
    """

    name: str
    excitation: str
    repeat: int
    period: float
    stage_clock: Array
    motor: Array
    effort: Array | None = None
    reference: Array | None = None
    reference_velocity: Array | None = None
    command: Array | None = None
    echo: Array | None = None
    load: Array | None = None
    wrench: Array | None = None
    tracker_index: NDArray[np.int64] | None = None
    tracker_position: Array | None = None
    tracker_rotation: Array | None = None
    contact: Array | None = None
    contact_known: NDArray[np.bool_] | None = None
    temperature: Array | None = None
    session_time: float = 0.0
    payload: tuple[tuple[float, float, float, float, float], ...] = ()
    start: int = 0
    lost: NDArray[np.bool_] | None = None
    stale: NDArray[np.bool_] | None = None
    held: NDArray[np.bool_] | None = None

    @property
    def axes(self) -> int:
        """Number of actuators."""
        return self.motor.shape[1]

    @cached_property
    def inner(self) -> NDArray[np.bool_]:
        """(g,) False where the ends of the filter, or a lost tick, spoil a sample."""
        if self.lost is None:
            return self.between_ends()
        near = np.flatnonzero(self.lost)
        return self.between_ends() & (np.abs(self.grid[:, None] - near).min(axis=1) > self.edge)

    @cached_property
    def pieces(self) -> NDArray[np.int64]:
        """(g,) number of lost ticks before each sample: where it changes, what was summed up since is not known."""
        if self.lost is None:
            return np.zeros(len(self.grid), dtype=np.int64)
        return np.cumsum(self.lost)[self.grid]

    @cached_property
    def echo_tells(self) -> NDArray[np.bool_]:
        """(n,) False where the echo cannot be compared: at the first tick, held ones, and lost ones and behind."""
        tells = np.arange(self.ticks) > 0
        if self.held is not None:
            tells &= ~self.held
        if self.lost is not None:
            for behind in range(3):
                tells[behind:] &= ~self.lost[: self.ticks - behind]
        return tells

    @property
    def command_counts(self) -> NDArray[np.bool_]:
        """(n,) False where the host's command cannot be computed again: at lost and stale ticks."""
        counts = np.ones(self.ticks, dtype=bool)
        for odd in (self.lost, self.stale):
            if odd is not None:
                counts &= ~odd
        return counts

    @cached_property
    def tracker_slot(self) -> NDArray[np.int64]:
        """(m,) sample of the residual grid that each tracker sample is nearest to."""
        assert self.tracker_index is not None
        return np.clip(np.rint(self.tracker_index / self.stride).astype(np.int64), 0, len(self.grid) - 1)

    @cached_property
    def loaded_ok(self) -> NDArray[np.bool_]:
        """(g,) True where the contact force is known."""
        if self.contact_known is None:
            return np.ones(len(self.grid), dtype=bool)
        return self.contact_known[self.grid]

    @cached_property
    def smooth_load(self) -> Array | None:
        """Load encoder position after the low-pass, (n, axes)."""
        return None if self.load is None else self.filtered(self.load)
