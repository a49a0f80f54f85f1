"""What is read from a bag: known motions of the three sliders, which are the tip's own along z."""

from __future__ import annotations

import json

import numpy as np
import pytest
from sher3_bags.run import Run, Stream
from sher3_description import load_robot
from sher3_safety.errors import MeasurementError
from sher3_safety.measurement.recording import Recording

ROBOT = load_robot()
PERIOD, SPEED = 2_000_000, 5e-3
START = 10**18
ONSET, END, RELEASE, PRESS, ROWS = 100, 200, 230, 240, 300
STANDS = 0.5e-6


def texts(topic_type="std_msgs/msg/String", *entries):
    stamp = np.array([START + row * PERIOD for row, _ in entries], dtype=np.int64)
    return Stream(topic_type, stamp, columns={"data": tuple(json.dumps(data) for _, data in entries)})


def recording(moving, *, reason="WRENCH_STALE", seen=110, state="ENABLED", before="ENABLED", wall=False, kept=ROWS):
    """Return a bag in which the tip moves at SPEED in the rows where `moving` is true; only some rows are `kept`."""
    velocity = np.where(moving, SPEED, 0.0)
    z = np.concatenate([[0.0], np.cumsum(velocity[:-1]) * PERIOD * 1e-9])
    stamp = START + PERIOD * np.arange(ROWS, dtype=np.int64)
    axes = np.array([1.0, 1.0, 1.0, 0.0, 0.0])
    columns = {"position": z[:kept, None] * axes, "velocity": velocity[:kept, None] * axes, "effort": None}
    rows = np.arange(ROWS)
    foot = np.where((rows < RELEASE) | (rows >= PRESS), 1.0, 0.0)
    label = {"label": "cell", "component": "force_sensor"}
    status = [(0, {"reason": "MOVING"}), (seen, {"reason": reason})] if reason else [(0, {"reason": "MOVING"})]
    fault = {"state": state, "first_fault": {"code": "X"} if state == "FAULT" else None}
    streams = {
        "mock/true_js": Stream("sensor_msgs/msg/JointState", stamp[:kept], columns=columns),
        "mock/pedal": Stream("sensor_msgs/msg/Joy", stamp, columns={"axes": foot[:, None], "buttons": None}),
        "mock/fault": texts("std_msgs/msg/String", (ONSET, {**label, "fault": "off"}), (END, {**label, "fault": "ok"})),
        "admittance/status": texts("std_msgs/msg/String", *status),
        "supervisor/status": texts("std_msgs/msg/String", (seen + 5, fault)),
        "operating_state": Stream("std_msgs/msg/String", stamp[:1], columns={"data": (before,)}),
    }
    return Recording(Run(streams), ROBOT, None if wall else PERIOD * 1e-9)


def outcome(moving, **settings):
    (found,) = recording(moving, **settings).outcomes(lambda _: STANDS)
    return found


def rows(*spans):
    row = np.arange(ROWS)
    return np.logical_or.reduce([(row >= first) & (row < last) for first, last in spans])


def test_a_stop_is_measured_in_time_and_way():
    found = outcome(rows((0, 112), (PRESS, ROWS)))
    assert found.speed == pytest.approx(SPEED, rel=1e-6)
    # 1 mm from the middle of 76 mm; the tilt's travel lies 1.4 mm off its own.
    assert found.to_end == pytest.approx(0.0228 / 0.0484, rel=1e-6)
    assert found.reason == "WRENCH_STALE" and not found.fault
    assert found.detection == pytest.approx(0.020)
    assert found.stop == pytest.approx(0.024)
    assert found.travel == pytest.approx(12 * 2e-3 * SPEED, rel=1e-6)
    assert found.excess < 1e-9
    assert found.alone == 0.0
    assert found.resumed > 100e-6


def test_a_fall_of_the_demand_before_the_report_is_the_detection():
    assert outcome(rows((0, 105)), seen=150).detection == pytest.approx(0.010)


def test_a_robot_that_goes_on_neither_stops_nor_leaves_its_way():
    found = outcome(rows((0, ROWS)), reason="")
    assert found.stop is None and found.detection is None and not found.tripped
    assert found.excess < 1e-9 and found.travel == pytest.approx(0.2 * SPEED, rel=1e-6)


def test_motion_by_itself_is_told_from_motion_after_the_press():
    found = outcome(rows((0, 110), (210, 220)))
    assert found.alone == pytest.approx(10 * 2e-3 * SPEED, rel=1e-6)
    assert found.resumed == 0.0


def test_a_robot_that_starts_again_during_the_observation_travels_on():
    found = outcome(rows((0, 110), (150, 180)))
    assert found.travel == pytest.approx(40 * 2e-3 * SPEED, rel=1e-6)
    assert found.stop == pytest.approx(0.160)


def test_running_ahead_of_the_way_is_excess():
    """At rest before, moving after: all of the way is off the way."""
    found = outcome(rows((ONSET, 120)))
    assert found.speed == 0.0
    assert found.excess == pytest.approx(20 * 2e-3 * SPEED, rel=1e-6)


def test_what_has_moved_by_the_row_of_the_fault_is_of_the_fault():
    """It moves from the row before on: the speed before is still none, and that row's way is off the way."""
    found = outcome(rows((ONSET - 1, 120)))
    assert found.speed == 0.0 and found.excess == pytest.approx(21 * 2e-3 * SPEED, rel=1e-6)


def test_fault_and_its_code_are_read():
    found = outcome(rows((0, 112)), reason="", state="FAULT")
    assert found.fault and found.reason == "X"


def test_without_the_truth_nothing_is_measured():
    with pytest.raises(MeasurementError, match="true_js"):
        Recording(Run({}), ROBOT)


def test_the_state_at_the_onset_the_fault_and_the_way_after_the_report_are_told():
    found = outcome(rows((0, 120)), state="FAULT")
    assert found.operating == "ENABLED" and found.fault_reason == "X"
    assert found.faulted == pytest.approx(0.030)
    assert found.braking == pytest.approx(10 * 2e-3 * SPEED, rel=1e-6)
    assert outcome(rows((0, 120)), before="PAUSED").operating == "PAUSED"


def test_in_wall_time_a_fault_that_ends_the_plant_is_timed_without_it():
    """The last row is the one before the onset: speed and place are those of before, times are those of the reports."""
    found = outcome(rows((0, ROWS)), wall=True, kept=ONSET, state="FAULT")
    assert found.speed == pytest.approx(SPEED, rel=1e-6)
    assert found.detection == pytest.approx(0.022) and found.faulted == pytest.approx(0.032)
    assert found.travel == 0.0 and found.stop is None
