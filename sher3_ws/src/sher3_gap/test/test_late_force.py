"""Readings while a load changes count: a force channel that is late shows there and nowhere else."""

from dataclasses import replace

import numpy as np
import pytest
from sher3_diagnosis.channel import Channel
from sher3_gap.stages.geometry import Geometry, changing
from sher3_gap.stages.residuals import wrench_residual
from simulated import ROBOT, runs_of, signals

SENSOR = Channel("sensing", "force_sensor")


@pytest.fixture(scope="module")
def run():
    """Return a run with known loads that come and go."""
    return signals(runs_of(("loads",), repeats=1))[0]


def late(run, channels, delay):
    """Return the run with channels of the force sensor that tell what they were `delay` ago, s."""
    wrench, clock = run.wrench.copy(), run.stage_clock
    for i in channels:
        wrench[:, i] = np.interp(clock - delay, clock, wrench[:, i])
    return replace(run, wrench=wrench)


def largest(run):
    """Return the largest disagreement of the force sensor while loads change, and elsewhere, (6,) each."""
    found = wrench_residual(run, Geometry(ROBOT))[SENSOR]
    ramp = np.any(changing(run), axis=(0, 2))
    values = np.abs(found.values)
    return values[found.ok & ramp].max(axis=0), values[found.ok & ~ramp].max(axis=0)


def test_a_load_that_changes_is_no_gap(run):
    ramp, plateau = largest(run)
    assert np.all(ramp < 1.5 * plateau)


@pytest.mark.parametrize(("channel", "delay"), [(0, 2e-3), (4, 5e-3)])
def test_a_late_channel_shows_while_a_load_changes_and_nowhere_else(run, channel, delay):
    healthy, _ = largest(run)
    ramp, plateau = largest(late(run, (channel,), delay))
    assert ramp[channel] > 5.0 * healthy[channel]
    assert plateau[channel] < 2.0 * healthy[channel]


def test_what_the_size_of_a_changing_load_would_add_does_not_count(run):
    found = wrench_residual(run, Geometry(ROBOT))[SENSOR]
    path = Geometry(ROBOT).path(run)
    ramp = np.any(changing(run), axis=(0, 2))[found.ok]
    assert path.determined is not None and ramp.sum() > 50
    load = np.where(np.any(changing(run), axis=(0, 2))[:, None], Geometry(ROBOT).path(run).contact_wrench, 0.0)
    kept = found.relieved(load[found.ok])[ramp]
    assert np.abs(kept).max() < 0.02 * np.abs(load).max()
