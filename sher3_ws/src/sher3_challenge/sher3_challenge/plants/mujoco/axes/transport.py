"""Transport of commands: when they arrive, what the drive holds meanwhile, and the mean it echoes."""

from __future__ import annotations

import math

import numpy as np

from sher3_challenge.plants.mujoco.axes.mjcf import SUBSTEPS
from sher3_challenge.plants.mujoco.axes.parts import AXES, Array, Axis


def arrivals(ticks: int, period: float, delay: Array, jitter: float, loss: float, rng: np.random.Generator) -> Array:
    """Return (ticks, 5) times from tick to arrival [s]; inf where a command is lost. Order is kept.

    Args:
        ticks: number of commands.
        period: time between them [s].
        delay: (5,) fixed lateness [s].
        jitter: scale of a half-normal lateness, the same for all axes of a tick [s].
        loss: probability that a command is lost.
        rng: source of what is random.
    """
    clock = period * np.arange(ticks)[:, None]
    late = np.abs(jitter * rng.standard_normal((ticks, 1)))
    lost = rng.random(ticks) < loss
    arrival = np.maximum.accumulate(clock + late + delay, axis=0) - clock
    arrival[lost] = np.inf
    arrival[0] = np.where(lost[0], 0.0, arrival[0])
    return np.asarray(arrival)


class Transport:
    """A queue for each axis; `demand` (SUBSTEPS, 5) is what the drive acts on during the tick that was taken last."""

    def __init__(self, arrival: Array, period: float, axes: list[Axis], hold: Array) -> None:
        self.due = np.arange(len(arrival))[:, None] * period + arrival
        self.period, self.step = period, period / SUBSTEPS
        self.prompt = ~((arrival > 0) & np.isfinite(arrival)).any(axis=1)
        self.every = bool((hold == 1).all())
        self.hold = hold
        self.lost = np.isinf(arrival)
        self.held = np.zeros(AXES)
        self.next = [0] * AXES
        self.steady = True
        self.deadband = np.array([axis.deadband for axis in axes])
        self.dead = bool(self.deadband.any())
        self.demand = np.zeros((SUBSTEPS, AXES))

    def take(self, k: int, command: Array) -> Array:
        """Take what arrives during tick `k`; return (5,) the mean demand over the tick, as the drive echoes it."""
        self.steady = bool(self.prompt[k]) and min(self.next) == k
        if self.steady:
            kept = self.lost[k] if self.every else self.lost[k] | ((k % self.hold) != 0)
            self.next = [k + 1] * AXES
            self.held = np.where(kept, self.held, command[k])
            self.demand[:] = mean = self.held
        else:
            for j in range(AXES):
                self._take_axis(k, j, command)
            mean = self.demand.mean(axis=0)
        if self.dead:
            self.demand[np.abs(self.demand) <= self.deadband] = 0.0
        return mean

    def _take_axis(self, k: int, j: int, command: Array) -> None:
        begin, row = k * self.period, self.demand[:, j]
        row[:] = self.held[j]
        while self.next[j] <= k:
            due = self.due[self.next[j], j]
            place = max(0.0, (due - begin) / self.step)
            if due != math.inf:
                if place >= SUBSTEPS - 1e-9:
                    break
                # a command that arrives within a substep counts for the rest of it
                whole, new = int(place), command[self.next[j], j]
                row[whole] += (1 - place + whole) * (new - row[whole])
                row[whole + 1 :] = self.held[j] = new
            self.next[j] += 1
