"""A recording with lost samples drives the simulator as the whole one does: rows go by their stamps, not by count."""

from dataclasses import replace

import numpy as np
import pytest
from sher3_bags import Run
from sher3_description import load_robot
from sher3_sim import contact_wrench, resimulate, simulate

ROBOT = load_robot()
LOST = {"servo_jv": 300, "force/measured_cf": 100, "measured_js": 200}
"""Topic -> its sample that was lost."""


@pytest.fixture(scope="module")
def run():
    """Two seconds in which the legs rise and sink by 2 mm under a push that comes and goes."""
    time = np.arange(1000) * ROBOT.control_period
    wave = 1 - np.cos(np.pi * time)
    return simulate(ROBOT, np.outer(1e-3 * wave, [1.0, 1.0, 1.0, 0.0, 0.0]), np.outer(wave, [0.5, 0, 0, 0, 0, 0]))


def lossy(run):
    streams = {}
    for name, stream in run.streams.items():
        keep = np.arange(len(stream)) != LOST.get(name, -1)
        columns = {column: values[keep] for column, values in stream.columns.items()}
        streams[name] = replace(stream, stamp=stream.stamp[keep], columns=columns)
    return Run(streams, run.metadata)


def test_lost_samples_shift_nothing(run):
    whole, part = (resimulate(r, ROBOT, open_loop=True)["measured_js"] for r in (run, lossy(run)))
    assert np.array_equal(part.stamp, whole.stamp)
    assert np.abs(part.position - whole.position)[:, :3].max() < 3e-7, "a step of the encoder; a tick is 6 um of motion"


def test_the_wrench_of_a_lost_sample_is_the_one_before(run):
    whole, part = contact_wrench(run, ROBOT, 3), contact_wrench(lossy(run), ROBOT, 3)
    assert len(part) == len(run["measured_js"]) - 1
    assert part[120] == pytest.approx(whole[120], abs=1e-12) and part[300] == pytest.approx(whole[301], abs=1e-12)
    assert 0 < np.abs(part[100] - whole[100]).max() < 0.05
