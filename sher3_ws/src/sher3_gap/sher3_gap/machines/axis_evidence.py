"""Residuals and floors of a machine's axes, in blocks that take the place of runs when nothing was repeated."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sher3_gap.channels import Array, Channel, Residual
from sher3_gap.fitting import Whitened
from sher3_gap.floors import Floors, repeat_floors
from sher3_gap.machines.axis_view import AxisSignals, AxisView, signals_of
from sher3_gap.machines.description import Axis
from sher3_gap.machines.identify import identify_mass
from sher3_gap.machines.intake import AxesRun
from sher3_gap.residuals import Residuals, settled
from sher3_gap.signals import low_pass

BLOCKS = 8
"""Least number of blocks that held-out losses and intervals are taken over."""
MIN_BLOCK = 4
"""Least number of samples that count in a block."""
GAUSSIAN = 1.4826


@dataclass(frozen=True)
class AxisEvidence:
    """The engine's evidence for one axis: a block of a record is a run.

    Attributes:
        runs, views: per block (blocks of one record share theirs); `records`: the views, one a record.
        mass: nominal or identified.
    """

    axis: Axis
    runs: list[AxisSignals]
    views: list[AxisView]
    data: Whitened
    records: list[AxisView]
    mass: float
    mass_interval: tuple[float, float] | None

    @property
    def floors(self) -> list[Floors]:
        """Floor per block and channel."""
        return self.data.floors

    def count(self, channel: Channel) -> float:
        """Return inf: a description does not say where two encoders have their zeros, so no mean of theirs is a gap."""
        return math.inf


def gather_axis(runs: Sequence[AxesRun], axis: Axis, repeats: bool) -> AxisEvidence:
    """Residuals, floors and blocks of one axis. Raises `MachineError` when an unknown mass cannot be identified."""
    signals = [signals_of(r, axis, "repeats" if repeats else r.name) for r in runs]
    mass, interval = (axis.mass, None) if isinstance(axis.mass, float) else (0.0, None)
    if axis.mass == "unknown":
        mass, interval = identify_mass([AxisView(s, axis, 0.0) for s in signals])
    records = [AxisView(s, axis, mass or 0.0) for s in signals]
    found = [residuals(v) for v in records]
    floors = floors_of(records, found, repeats)
    blocks = [(r, b) for r, x in enumerate(found) for b in _blocks(x, -(-BLOCKS // len(records)))]
    data = Whitened([records[r] for r, _ in blocks], [b for _, b in blocks], [floors[r] for r, _ in blocks])
    views = [records[r] for r, _ in blocks]
    return AxisEvidence(axis, [v.signals for v in views], views, data, records, mass or 0.0, interval)


def residuals(view: AxisView) -> Residuals:
    """Residuals of one record: force balance (servo: tracking error), and load encoder minus motor encoder."""
    run, axis = view.run, view.axis
    out: Residuals = {}
    if axis.command_law.kind == "position":
        assert run.reference is not None
        out[Channel("motor_mechanics", axis.name)] = Residual(run.to_grid(run.reference - run.motor), run.inner)
    elif axis.mass is not None and run.effort is not None:
        values = run.to_grid(run.effort) - view.inertial
        out[Channel("motor_mechanics", axis.name)] = Residual(values, run.inner & view.free & settled(view.moving, 1))
    if run.load is not None:
        out[Channel("transmission", axis.name)] = Residual(run.to_grid(run.load - run.motor), run.inner)
    return {c: x for c, x in out.items() if x.ok.sum() >= BLOCKS}


def floors_of(records: Sequence[AxisView], found: Sequence[Residuals], repeats: bool) -> list[Floors]:
    """Floor per record: between repeats where there are any, else the innovations; never below what a count makes."""
    pooled = repeat_floors([v.run for v in records], [*found]) if repeats else {}
    out = []
    for view, residual in zip(records, found, strict=True):
        least = resolution_floor(view)
        out.append({c: np.maximum(pooled.get(c, innovation(x)), least[c.stage]) for c, x in residual.items()})
    return out


def resolution_floor(view: AxisView) -> dict[str, Array]:
    """What quantisation alone makes: white noise of a count's variance through the same filters."""
    run, axis = view.signals, view.axis
    count = axis.encoder_resolution / np.sqrt(12.0)
    noise = np.random.default_rng(0).normal(size=(max(run.ticks, 400), 1))
    bend = np.zeros_like(noise)
    bend[1:-1] = np.diff(noise, 2, axis=0) / run.period**2
    filtered = {k: float(run_filter(run, x).std()) for k, x in (("x", noise), ("a", bend))}
    effort = axis.effort_resolution / np.sqrt(12.0) * filtered["x"]
    force = np.hypot(effort, count * view.robot.actuators[0].mass * filtered["a"])
    if axis.command_law.kind == "position":
        force = count
    return {"motor_mechanics": np.array([max(force, 1e-12)]), "transmission": np.array([np.sqrt(2.0) * count])}


def run_filter(run: AxisSignals, x: Array) -> Array:
    """The low-pass of a run on a signal of any length."""
    return low_pass(x, run.period, run.bandwidth)


def innovation(residual: Residual) -> Array:
    """What neighbouring samples of a residual differ by beyond a straight line: its unforeseeable part, (d,).

    Second differences of white noise of variance s^2 have variance 6 s^2; the median leaves reversals and steps out.
    """
    x = residual.values[residual.ok]
    bend = np.diff(x, 2, axis=0)
    return GAUSSIAN * np.median(np.abs(bend), axis=0) / np.sqrt(6.0)


def _blocks(found: Residuals, number: int) -> list[Residuals]:
    """Cut a record into blocks with equal numbers of samples that count."""
    if not found:
        return []
    lead = max(found.values(), key=lambda x: int(x.ok.sum())).ok
    number = max(1, min(number, int(lead.sum()) // MIN_BLOCK))
    share = np.minimum(np.cumsum(lead) * number // (int(lead.sum()) + 1), number - 1)
    return [{c: Residual(x.values, x.ok & (share == k)) for c, x in found.items()} for k in range(number)]
