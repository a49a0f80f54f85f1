"""A recorded command less its law, and the floor of what is left."""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array, Residual
from sher3_diagnosis.localise.floors import UNIFORM
from sher3_machines.thresholds import BLOCKS

from sher3_chain.axes.command.sampling import Sampling, stated_law
from sher3_chain.axes.view import AxisView
from sher3_chain.floors.innovation import foresight, innovation
from sher3_chain.joint.description import Axis
from sher3_chain.readings.signals import AxisSignals
from sher3_chain.thresholds import LAW_ROUNDED


class LawView(AxisView):
    """A run of one axis with the law that its command was stated to follow.

    Attributes:
        stated: the law on what was recorded.
        sampling: of its encoder.
    """

    def __init__(self, run: AxisSignals, axis: Axis, sampling: Sampling) -> None:
        super().__init__(run, axis, 0.0)
        self.stated = stated_law(run, axis, sampling)
        self.sampling = sampling


def residual_of(view: LawView) -> Residual:
    """Return command less law, (g, 1) in the command's unit."""
    run = view.run
    assert run.command is not None
    left = run.to_grid(run.command - view.stated.command[:, None])
    return Residual(left, run.inner)


def floor_of(view: LawView, left: Residual) -> Array:
    """Return the floor (1,) of command less law, in the command's unit.

    It is the innovation of the residual, and never less than what encoder counts, the command's own steps, gains of few
    digits and unknown readings between two samples make together.
    """
    run, law = view.run, view.described.command_law
    assert run.command is not None and law.position_gain is not None
    noise = np.random.default_rng(0).normal(size=(max(run.ticks, 4 * BLOCKS), 1))
    count = view.described.encoder_resolution / UNIFORM
    shaken = law.position_gain * noise - law.velocity_gain * np.diff(noise, axis=0, prepend=0.0) / run.period
    steps = np.diff(np.unique(run.command))
    rounded = (float(steps.min()) if len(steps) else 0.0) / UNIFORM
    written = LAW_ROUNDED * float(np.sqrt(np.mean(run.command**2)))
    apart = (count * run.filtered(shaken).std(), rounded, law.velocity_gain * difference_error(view), written)
    return np.maximum(innovation(left) / foresight(run), max(float(np.linalg.norm(apart)), np.finfo(float).tiny))


def difference_error(view: LawView) -> float:
    """Return the rms error of a speed taken by differences about a sample, m/s or rad/s.

    Differences over h are off by a term in h^2: those over 2 h, less those over h, are three times it (Richardson).
    A controller that reads at the rate of the log, or slower, knows no more than the log.
    """
    if view.sampling.pace.over >= 1.0:
        return 0.0
    run, q = view.run, view.run.motor[:, 0]
    wide = np.gradient(q, run.period)
    wide[2:-2] = (q[4:] - q[:-4]) / (4.0 * run.period)
    off = run.to_grid((wide - np.gradient(q, run.period))[:, None])[run.inner] / 3.0
    return float(np.sqrt(np.mean(off**2)))
