"""One axis of a machine as the library of effects sees it: a run of a single actuator and its nominal forces.

The library names SHER's actuators. An axis is shown to it under the name of the first of them (`SEEN_AS`), and what
comes back is put under the axis' own name; the effects themselves are the same code.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace
from typing import cast

import numpy as np
from numpy.typing import NDArray
from sher3_description import ACTUATORS, Robot

from sher3_gap.channels import Array
from sher3_gap.geometry import Geometry, Path
from sher3_gap.library import View
from sher3_gap.machines.description import Axis
from sher3_gap.machines.intake import AxesRun
from sher3_gap.residuals import settled
from sher3_gap.signals import BANDWIDTH, DECIMATED_RATE, EDGE, RunSignals, low_pass

SEEN_AS = ACTUATORS[0]
NYQUIST_SHARE = 0.4
"""Cut-off over the Nyquist rate where the record is too slow for `BANDWIDTH`: two differentiations must survive it."""

SLIP = 1e-9
"""Viscous coefficient in place of none: effects take it as a scale."""


@dataclass(frozen=True)
class AxisSignals(RunSignals):
    """Signals of one axis, (n, 1) each, filtered at a cut-off that suits the record's rate."""

    bandwidth: float = BANDWIDTH

    @cached_property
    def stride(self) -> int:
        """Ticks per sample of the residual grid: 2.5 samples per period of the cut-off, as on SHER."""
        return max(1, round(BANDWIDTH / self.bandwidth / (DECIMATED_RATE * self.period)))

    @cached_property
    def inner(self) -> NDArray[np.bool_]:
        """(g,) False where the filter's ends spoil a sample."""
        edge = EDGE * BANDWIDTH / self.bandwidth / self.period
        return (self.grid >= edge) & (self.grid < self.ticks - edge)

    @cached_property
    def smooth(self) -> Array:
        """Position after the low-pass, (n, 1)."""
        return low_pass(self.motor, self.period, self.bandwidth)

    def to_grid(self, x: Array) -> Array:
        """Low-pass an (n, ...) signal and sample it on the residual grid."""
        return low_pass(x, self.period, self.bandwidth)[self.grid]


def signals_of(run: AxesRun, axis: Axis, excitation: str) -> AxisSignals:
    """Signals of an axis; `effort` is the measured force, or the force the command asks for."""
    found = {k: x[:, None] for k, x in run.signals[axis.name].items()}
    law = axis.command_law
    effort = found.get("effort")
    if effort is None and "command" in found:
        effort = law.gain * (held_mean(found["command"]) if law.held else found["command"])
    if effort is None and law.kind == "none":
        effort = np.zeros_like(found["position"])
    return AxisSignals(
        name=run.name,
        excitation=excitation,
        repeat=0,
        period=run.period,
        stage_clock=run.period * np.arange(len(found["position"]), dtype=np.float64),
        motor=found["position"],
        effort=effort,
        reference=found.get("reference"),
        command=found.get("command"),
        load=found.get("load"),
        bandwidth=min(BANDWIDTH, NYQUIST_SHARE * 0.5 / run.period),
    )


def held_mean(command: Array) -> Array:
    """Mean around each sample of a command that is held from one sample to the next, (n, 1)."""
    out = command.copy()
    out[1:] = 0.5 * (command[1:] + command[:-1])
    return out


class AxisView(View):
    """A run of one axis with its nominal forces.

    Attributes:
        mass: nominal mass, or the one identified.
    """

    def __init__(self, run: AxisSignals, axis: Axis, mass: float) -> None:
        lead = axis.lead or (2.0 * np.pi if axis.motion == "rotary" else 0.02 * max(float(np.ptp(run.motor)), 1e-9))
        top = float(np.abs(run.velocity).max())
        actuator = SimpleNamespace(
            mass=mass, viscous=max(axis.viscous, SLIP), lead=lead, limits=SimpleNamespace(velocity=max(top, 1e-12))
        )
        super().__init__(run, cast(Robot, SimpleNamespace(actuators=[actuator])), cast(Geometry, None))
        self.axis = axis
        self.signals = run

    @cached_property
    def path(self) -> Path:
        """Nominal weight along the motion; no contact."""
        run, law = self.run, self.axis.gravity
        weight = law.constant + law.arm * np.sin(run.smooth[run.grid] - law.hanging)
        g = len(run.grid)
        none, wrench, turn = np.zeros((g, 3)), np.zeros((g, 6)), np.tile(np.eye(3), (g, 1, 1))
        unloaded = np.zeros(g, dtype=bool)
        return Path(none, turn, np.zeros((g, 6, 1)), weight, none, np.zeros_like(weight), unloaded, wrench, wrench)

    @cached_property
    def moving(self) -> NDArray[np.bool_]:
        """(g,) True where the axis moves: at rest friction takes any value, and the force balance says nothing."""
        run = self.run
        half = max(1, run.stride)
        before = run.smooth[np.maximum(run.grid - half, 0), 0]
        after = run.smooth[np.minimum(run.grid + half, run.ticks - 1), 0]
        return np.abs(after - before) > self.axis.encoder_resolution

    @cached_property
    def free(self) -> NDArray[np.bool_]:
        """(g,) False for an undriven axis before it is let go: until then something else holds it."""
        if self.axis.command_law.kind != "none":
            return np.ones(len(self.run.grid), dtype=bool)
        return self.run.grid >= self.release

    @cached_property
    def release(self) -> int:
        """Tick at which the stretch of motion with the largest travel begins."""
        edges = np.flatnonzero(np.diff(np.concatenate([[0], self.moving.astype(int), [0]])))
        q = self.position[:, 0]
        travel = [abs(q[min(b, len(q) - 1)] - q[a]) for a, b in zip(edges[::2], edges[1::2], strict=True)]
        return int(self.run.grid[edges[::2][int(np.argmax(travel))]]) if travel else 0

    @cached_property
    def at_rest(self) -> NDArray[np.bool_]:
        """(g,) True well inside a stretch without motion."""
        return self.run.inner & self.free & settled(~self.moving, 2)
