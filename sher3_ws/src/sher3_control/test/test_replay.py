"""A recorded session computed again gives the recorded commands bit for bit, and a changed sample is found."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from control_graph import RECORDED, control_graph
from law_bench import ROBOT
from sher3_common.reasons import Reason
from sher3_common.samples import JointSample
from sher3_control.replay import ReplayError, replay_admittance, replay_motion
from sher3_control.tick_records import motion_record

pytestmark = pytest.mark.graph


def columns(samples):
    """Turn samples into the columns of a recorded stream."""
    if hasattr(samples[0], "text"):
        return SimpleNamespace(data=[s.text for s in samples])
    table = SimpleNamespace(stamp=np.array([s.stamp for s in samples]))
    first = samples[0]
    if hasattr(first, "twist"):
        both = np.array([s.twist for s in samples])
        table.linear, table.angular = both[:, :3], both[:, 3:]
    elif hasattr(first, "wrench"):
        both = np.array([s.wrench for s in samples])
        table.force, table.torque = both[:, :3], both[:, 3:]
    elif hasattr(first, "axes"):
        # The message holds 32-bit numbers.
        table.axes = np.array([s.axes for s in samples], dtype=np.float32)
        table.buttons = np.array([s.buttons for s in samples])
    elif hasattr(first, "orientation"):
        table.position = np.array([s.position for s in samples])
    else:
        for name in ("position", "velocity"):
            values = [getattr(s, name) for s in samples]
            setattr(table, name, None if values[0] is None else np.array(values))
    return table


@pytest.fixture(scope="module")
def session():
    """Return a session with pushes, live changes, a tare, a remote centre, a move and a fault."""
    with control_graph() as g:
        rng = np.random.default_rng(3)

        def push(ticks):
            for _ in range(ticks):
                g.robot.force = tuple(rng.normal(0.3, 0.3, 3))
                g.robot.travel = float(rng.uniform(0.3, 1.0))
                g.step()

        g.enable()
        g.press()
        push(80)
        g.text("admittance", "linear_gain 0.002")
        push(40)
        g.text("admittance", "speed_scale 0.3")
        g.text("admittance", "axis_lock translate")
        push(40)
        g.robot.travel = 0.0
        g.step(3)
        g.until_mode(None)
        g.text("rcm", "here 0.018")
        g.text("admittance", "axis_lock free")
        g.press()
        push(80)
        g.robot.force = (float("nan"), 0.0, 0.0)
        g.step(3)
        g.press()
        push(30)
        g.robot.travel = 0.0
        g.step(5)
        g.until_mode(None)
        g.probe.send("command/move_jp", JointSample(g.now, (0.001, 0.0, -0.001, 0.01, 0.0)))
        g.graph.settle()
        g.step(150)
        streams = {name: columns(g.probe.samples[name]) for name in RECORDED if g.probe.samples[name]}
        return SimpleNamespace(streams=streams)


def test_both_laws_give_the_recorded_commands_bit_for_bit(session):
    for replay in (replay_admittance, replay_motion):
        result = replay(session, ROBOT)
        assert (result.different, result.skipped) == (0, 0)
        assert result.compared > 250
    moving = np.abs(session.streams["servo_jv"].velocity).max(axis=1) > 0.0
    assert moving.sum() > 250


def test_a_changed_sample_is_found(session):
    wrench = session.streams["force/measured_cf"]
    changed = SimpleNamespace(**vars(wrench))
    changed.force = wrench.force.copy()
    changed.force[50, 0] += 1e-12
    run = SimpleNamespace(streams={**session.streams, "force/measured_cf": changed})
    assert replay_admittance(run, ROBOT).different > 0
    joints = session.streams["measured_js"]
    shifted = SimpleNamespace(**vars(joints))
    shifted.position = joints.position + 1e-12
    assert replay_motion(SimpleNamespace(streams={**session.streams, "measured_js": shifted}), ROBOT).different > 0


def test_a_recording_from_the_middle_is_compared_from_the_first_released_pedal_on(session):
    cut = SimpleNamespace(data=session.streams["admittance/inputs"].data[60:])
    result = replay_admittance(SimpleNamespace(streams={**session.streams, "admittance/inputs": cut}), ROBOT)
    assert result.different == 0
    assert result.skipped > 0
    assert result.compared > 100


def test_a_motion_about_a_centre_is_compared_from_the_first_rest_on(session):
    """Its hold is part of the law: without it the commands differ, and from the middle of a motion it is not known."""
    texts = session.streams["motion/settings"].data
    centred = {data["version"] for data in map(json.loads, texts) if data["rcm"] is not None}
    lines = session.streams["motion/inputs"].data
    records = list(map(motion_record, lines))
    moving = [k for k, r in enumerate(records) if r.version in centred and r.reason == Reason.MOVING]
    # The pedal is pressed for 80 ticks, so 40 ticks on the robot moves about the centre.
    middle = next(k for k in moving if k + 40 in moving) + 40
    cut = SimpleNamespace(data=lines[middle:])
    result = replay_motion(SimpleNamespace(streams={**session.streams, "motion/inputs": cut}), ROBOT)
    assert result.different == 0 and result.skipped > 10 and result.compared > 50
    stiff = [text.replace('"rcm_integral": 500.0', '"rcm_integral": 400.0') for text in texts]
    assert stiff != texts
    changed = {**session.streams, "motion/settings": SimpleNamespace(data=stiff)}
    assert replay_motion(SimpleNamespace(streams=changed), ROBOT).different > 0


def test_a_missing_topic_or_sample_is_named(session):
    without = {k: v for k, v in session.streams.items() if k != "pedal/measured"}
    with pytest.raises(ReplayError, match="pedal/measured"):
        replay_admittance(SimpleNamespace(streams=without), ROBOT)
    wrench = session.streams["force/measured_cf"]
    short = SimpleNamespace(stamp=wrench.stamp[:-50], force=wrench.force[:-50], torque=wrench.torque[:-50])
    with pytest.raises(ReplayError, match="not in the run"):
        replay_admittance(SimpleNamespace(streams={**session.streams, "force/measured_cf": short}), ROBOT)
