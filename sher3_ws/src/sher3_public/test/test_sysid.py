"""Sequences of mujoco.sysid, made with its own TimeSeries, diagnosed without a change."""

from types import SimpleNamespace

import mujoco
import numpy as np
import pytest
import sher3.gap as gap
from mujoco.sysid._src.timeseries import SignalType, TimeSeries
from sher3_public.sysid import held


@pytest.fixture(scope="module")
def spec(log):
    """The nominal arm with a sensor on each joint and drive, and named drives."""
    spec = mujoco.MjSpec.from_string(log.xml)
    for joint, actuator in zip(("turn", "shoulder"), spec.actuators, strict=True):
        actuator.name = f"{joint}_drive"
        for what, kind, of in (
            ("place", mujoco.mjtSensor.mjSENS_JOINTPOS, (mujoco.mjtObj.mjOBJ_JOINT, joint)),
            ("force", mujoco.mjtSensor.mjSENS_ACTUATORFRC, (mujoco.mjtObj.mjOBJ_ACTUATOR, actuator.name)),
        ):
            spec.add_sensor(name=f"{joint}_{what}", type=kind, objtype=of[0], objname=of[1])
    return spec


def sequences(spec, *pairs):
    """Stand for a ModelSequences: its class needs the libraries of the extra `sysid`."""
    control, sensordata = zip(*pairs, strict=True)
    return SimpleNamespace(spec=spec, control=list(control), sensordata=list(sensordata))


def right(answer):
    (cause,) = answer.causes
    found = cause.parameters["force"].value
    return (cause.effect, cause.actuator) == ("coulomb_friction", "shoulder") and abs(found / 1.2 - 1.0) < 0.05


def test_positions_of_the_state_and_controls_by_name(spec, log):
    mapping = {f"{j}_qpos": (SignalType.MjStateQPos, np.array([i])) for i, j in ((1, "turn"), (0, "shoulder"))}
    control = {f"{j}_drive_ctrl": (SignalType.MjCtrl, np.array([i])) for i, j in ((1, "turn"), (0, "shoulder"))}
    turned = TimeSeries(log.time, log.qpos[:, ::-1].copy(), mapping)
    assert right(gap.from_sysid(sequences(spec, (TimeSeries(log.time, log.ctrl[:, ::-1].copy(), control), turned))))


def test_sensors_with_forces_in_the_order_of_the_model(spec, log):
    rows = np.column_stack([log.qpos[:, 0], log.actuator_force[:, 0], log.qpos[:, 1], log.actuator_force[:, 1]])
    mapping = TimeSeries.compute_all_sensor_mapping(spec.compile())
    for known in (mapping, None):
        answer = gap.from_sysid(sequences(spec, (TimeSeries(log.time, log.ctrl), TimeSeries(log.time, rows, known))))
        assert right(answer) and any("simulator's own" in guess for guess in answer.guessed)


def test_readings_of_a_rollout_are_those_of_the_beginning_of_its_steps(spec, log):
    """Its stamps are those of the end of a step: taken as they are, every joint is late by one."""
    step = spec.compile().opt.timestep
    names = {f"{j}_place": (SignalType.MjSensor, np.array([i])) for i, j in enumerate(("turn", "shoulder"))}
    answer = gap.from_sysid(
        sequences(spec, (TimeSeries(log.time, log.ctrl), TimeSeries(log.time + step, log.qpos, names)))
    )
    assert right(answer) and any("those of a rollout" in guess for guess in answer.guessed)


def test_controls_hold_until_the_next():
    values = held(np.array([[1.0], [2.0]]), np.array([0.0, 1.0]), np.array([-0.5, 0.0, 0.9, 1.0, 7.0]))
    assert values.ravel().tolist() == [1.0, 1.0, 1.0, 2.0, 2.0]


def test_what_is_no_sequence_is_said(spec, log):
    with pytest.raises(gap.InputError, match=r"no ModelSequences; value dict without spec, control, sensordata"):
        gap.from_sysid({})
    speeds = TimeSeries(log.time, log.qvel, {"turn_qvel": (SignalType.MjStateQVel, np.array([0]))})
    with pytest.raises(gap.InputError, match="no joint's position was measured"):
        gap.from_sysid(sequences(spec, (TimeSeries(log.time, log.ctrl), speeds)))
