"""A session at the robot in stepped time: each test drives every node over topics and CAN frames, and leaves a bag."""

from __future__ import annotations

import numpy as np
import pytest
from robot_rig import ROBOT, RobotRig
from sher3_bags.reading import read_run
from sher3_bags.recording.live import recorded
from sher3_bringup.surgeon.script import Script
from sher3_control.replay import replay_admittance, replay_motion
from sher3_description import TOPICS
from sher3_effects import plants
from sher3_runtime import Graph

pytestmark = pytest.mark.graph
PUSH = (1.1, 0.0, 0.0, 0.0, 0.0, 0.0)
PERIOD_NS = round(ROBOT.control_period * 1e9)


def session(*steps: dict) -> Script:
    """Return a script that waits for the streams, enables the robot and goes on with `steps`."""
    start = [{"name": "settle", "duration": 0.2}, {"name": "enable", "duration": 0.1, "command": "enable"}]
    return Script.model_validate({"schema": "sher3.teleop/1", "steps": [*start, *steps]})


def play(script: Script, request: pytest.FixtureRequest, effects=(), middleware=False):
    """Play a script, record it, and return the recorded run; by the middleware where what it carries is asked about."""
    with Graph(period=ROBOT.control_period, middleware=middleware) as graph:
        rig = RobotRig(graph, effects)
        with recorded(graph, request.node.nodeid.split("::")[-1], robot=ROBOT) as recorder:
            rig.play(script)
        return read_run(recorder.recorder.folder)


def between(run, topic, start, end):
    """Return the rows of a topic from `start` to `end` seconds after the first tick."""
    first = run["mock/pedal"].stamp[0]
    seconds = (run[topic].stamp - first) * 1e-9
    return (seconds >= start) & (seconds < end)


def test_the_tip_follows_the_hand(request):
    """Force minus deadband times gain: a newton beyond it is a millimetre per second, along the push."""
    run = play(session({"name": "push", "duration": 1.5, "pedal": 1.0, "wrench": PUSH, "ramp": 0.1}), request)
    steady = between(run, "measured_cp", 1.0, 1.7)
    tip = run["measured_cp"].position[steady]
    velocity = (tip[-1] - tip[0]) / (0.7 - ROBOT.control_period)
    expected = ROBOT.admittance.linear_gain * (PUSH[0] - ROBOT.admittance.force_deadband)
    assert velocity == pytest.approx([expected, 0.0, 0.0], abs=0.05 * expected)
    assert run["operating_state"].data[-1] == "ENABLED"


def test_every_tick_has_every_sample_with_its_stamp(request):
    """No sample is lost, late or stamped with another tick, in any stream that runs at the host rate."""
    run = play(session({"name": "push", "duration": 0.5, "pedal": 1.0, "wrench": PUSH}), request, middleware=True)
    streams = ("servo_jv", "drives/setpoint_jv", "drives/measured_js", "measured_js", "measured_cp", "pedal/measured")
    for topic in (*streams, "force/measured_cf", "servo_cv"):
        steps = np.diff(run[topic].stamp)
        assert len(steps) > 380 and (steps == PERIOD_NS).all(), topic
        assert (run[topic].stamp % PERIOD_NS == 0).all()
        if TOPICS[topic].frame_id:
            assert run[topic].frame_id == TOPICS[topic].frame_id


def test_the_command_of_a_tick_is_executed_until_the_next(request):
    """Nominal latency is zero: the echo of tick k is the command of tick k-1, to the resolution of the frames."""
    run = play(session({"name": "push", "duration": 0.6, "pedal": 1.0, "wrench": PUSH}), request)
    command = dict(zip(run["servo_jv"].stamp.tolist(), run["servo_jv"].velocity, strict=True))
    moving = 0
    for stamp, echo in zip(run["drives/setpoint_jv"].stamp.tolist(), run["drives/setpoint_jv"].velocity, strict=True):
        if stamp - PERIOD_NS in command and np.abs(command[stamp - PERIOD_NS]).max() > 1e-5:
            moving += 1
            assert np.abs(echo - command[stamp - PERIOD_NS]).max() < 1e-6
    assert moving > 100


def test_a_released_pedal_stops_in_the_same_tick_and_re_arms(request):
    """Zero in the tick of the release under full force; motion again after the next press."""
    released = {"name": "release", "duration": 0.4, "wrench": PUSH, "ramp": 0.0}
    again = {"name": "again", "duration": 0.8, "pedal": 1.0, "wrench": PUSH, "ramp": 0.0}
    first = {"name": "push", "duration": 0.8, "pedal": 1.0, "wrench": PUSH, "ramp": 0.0}
    run = play(session(first, released, again), request)
    pedal = dict(zip(run["pedal/measured"].stamp.tolist(), run["pedal/measured"].axes[:, 0], strict=True))
    speed = np.linalg.norm(run["servo_cv"].linear, axis=1)
    for stamp, value in zip(run["servo_cv"].stamp.tolist(), speed, strict=True):
        assert value == 0.0 or pedal[stamp] > 0.0
    assert speed[between(run, "servo_cv", 0.7, 1.0)].min() > 5e-4
    assert speed[between(run, "servo_cv", 1.8, 2.2)].min() > 5e-4


def test_the_bag_gives_the_same_commands_again(request):
    """Law and host law computed from the recorded inputs, bit for bit."""
    turn = {"name": "turn", "duration": 0.5, "pedal": 0.8, "wrench": (0.3, 0.5, -0.4, 0.02, 0.01, 0.0)}
    run = play(session({"name": "push", "duration": 0.5, "pedal": 1.0, "wrench": PUSH}, turn), request)
    for replay in (replay_admittance(run, ROBOT), replay_motion(run, ROBOT)):
        assert replay.compared > 400
        assert replay.different == 0


def test_effects_reach_the_running_plant(request):
    """A force bias of the sensor moves the tip without a hand: what an effect does shows in the graph."""
    bias = plants()["force_bias"](actuator="force_sensor", fx=0.6)
    run = play(session({"name": "wait", "duration": 0.8, "pedal": 1.0, "ramp": 0.0}), request, [bias])
    assert np.median(run["force/measured_cf"].force[:, 0]) == pytest.approx(0.6, abs=0.05)
    speed = run["servo_cv"].linear[between(run, "servo_cv", 0.8, 1.1), 0]
    assert np.median(speed) == pytest.approx(ROBOT.admittance.linear_gain * 0.5, rel=0.2)
