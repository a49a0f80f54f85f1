"""A small synthetic run of every type, and the practice cases where they are at hand."""

import os
from pathlib import Path

import numpy as np
import pytest
from sher3_bags import Run, RunMetadata, stream
from sher3_description import load_robot

ROOT = Path(__file__).parents[4]
SHARED = Path(os.environ.get("SHER3_SHARED", ROOT.parent / "shared"))


def make_run(n: int = 400, start: int = 1_700_000_000_123_456_789, seed: int = 1) -> Run:
    rng = np.random.default_rng(seed)
    stamp = start + np.arange(n) * 2_000_000
    latency = rng.integers(100_000, 400_000, n)
    joints = rng.normal(size=(3, n, 5)).cumsum(axis=1) * 1e-4
    streams = {
        "setpoint_js": stream("setpoint_js", stamp, position=joints[0], velocity=joints[1], log_time=stamp + latency),
        "servo_cv": stream("servo_cv", stamp, linear=rng.normal(size=(n, 3)), angular=rng.normal(size=(n, 3))),
        "servo_jv": stream("servo_jv", stamp, velocity=joints[1]),
        "drives/setpoint_jv": stream("drives/setpoint_jv", stamp, velocity=joints[2]),
        "drives/measured_js": stream(
            "drives/measured_js", stamp, position=joints[0], velocity=joints[1], effort=joints[2]
        ),
        "measured_js": stream("measured_js", stamp, position=joints[0] + 1e-6, log_time=stamp + latency // 2),
        "measured_cp": stream(
            "measured_cp", stamp, position=joints[1][:, :3], orientation=np.tile([0.0, 0.0, 0.0, 1.0], (n, 1))
        ),
        "force/measured_cf": stream(
            "force/measured_cf", stamp, force=rng.normal(size=(n, 3)), torque=rng.normal(size=(n, 3))
        ),
        "pedal/measured": stream("pedal/measured", stamp, axes=np.ones((n, 1)), buttons=np.zeros((n, 1))),
        "temperature": stream("temperature", stamp[::500], temperature=np.full(len(stamp[::500]), 22.5)),
        "operating_state": stream("operating_state", stamp[:2], data=["DISABLED", "ENABLED, größer"]),
    }
    metadata = RunMetadata("sweep", 2, 0.8, ((0.1, 0.2, 1.0, 0.0, -0.5),), "p1", "plant", 7, {"note": "synthetic"})
    return Run(streams, metadata, load_robot().to_yaml())


def assert_same_streams(a: Run, b: Run) -> None:
    assert list(a.streams) == list(b.streams)
    for topic in a.streams:
        one, two = a[topic], b[topic]
        assert (one.type, one.frame_id) == (two.type, two.frame_id)
        assert np.array_equal(one.stamp, two.stamp)
        for name, column in one.columns.items():
            assert np.array_equal(column, two.columns[name]), (topic, name)


@pytest.fixture
def fill_disk():
    """Return what lets the file of a recorder be one on a full disk; what was flushed before stays in the bag."""

    def fill(recorder):
        recorder.flush()
        full = os.open("/dev/full", os.O_WRONLY)
        os.dup2(full, recorder.fileno())
        os.close(full)

    return fill


@pytest.fixture
def run() -> Run:
    return make_run()


@pytest.fixture
def same_streams():
    return assert_same_streams


@pytest.fixture
def build():
    return make_run


@pytest.fixture
def practice() -> Path:
    folder = SHARED / "contract" / "practice"
    if not folder.is_dir():
        pytest.skip(f"no practice cases: {folder} is missing")
    return folder
