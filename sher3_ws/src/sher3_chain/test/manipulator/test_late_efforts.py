"""Efforts that are late beside dry friction: a delay of 5 ms is below the floor of a SCARA, and plain by its shape."""

from dataclasses import replace

import numpy as np
import pytest
from scaras import NAMES, machine, record
from sher3_diagnosis import diagnose

DRY = np.array([1.5, 2.0, 12.0])
MS = 1e-3


def verdict(path, rate, late):
    return diagnose(machine(path / "scara.urdf", rate), [record(rate, DRY, late)]).verdict


def commanded(path, rate, late):
    """Return the verdict where what the drives were told was logged, and no effort."""
    scara, run = machine(path / "scara.urdf", rate), record(rate, DRY, late)
    joints = []
    for joint in scara.described.joints:
        known = joint.signals.model_copy(update={"command": joint.signals.effort, "effort": None})
        joints.append(joint.model_copy(update={"signals": known}))
    signals = {j: {"command" if k == "effort" else k: x for k, x in own.items()} for j, own in run.signals.items()}
    told = replace(scara, described=scara.described.model_copy(update={"joints": tuple(joints)}))
    return diagnose(told, [replace(run, signals=signals)]).verdict


def test_what_was_told_before_the_motion_is_a_command_that_acts_late(tmp_path):
    causes = {c.actuator: c for c in commanded(tmp_path, 400.0, (0.0, -9 * MS, 0.0)).causes if c.family == "timing"}
    assert causes.keys() == {"elbow"} and causes["elbow"].effect == "command_delay"
    delay = causes["elbow"].parameters["delay"]
    assert delay.low < 9 * MS < delay.high and delay.value > 0.0


def told(found):
    return {c.actuator: c.parameters["effort_delay"] for c in found.causes if c.effect == "sensor_delay"}


def frictions(found):
    return {c.actuator: c.parameters["force"].value for c in found.causes if c.effect == "coulomb_friction"}


@pytest.mark.parametrize("rate", [200.0, 500.0, 1000.0])
def test_late_efforts_of_all_joints_are_named_beside_their_friction(tmp_path, rate):
    """The quill, whose force hardly changes but by its friction, does not tell it."""
    found = verdict(tmp_path, rate, (5 * MS, 5 * MS, 5 * MS))
    assert found.status == "attributed"
    assert {c.effect for c in found.causes} == {"sensor_delay", "coulomb_friction"}
    assert set(told(found)) == {"shoulder", "elbow"}
    for delay in told(found).values():
        assert delay.low < 5 * MS < delay.high and delay.high - delay.low < 5 * MS
    assert frictions(found) == pytest.approx(dict(zip(NAMES, DRY, strict=True)), rel=0.02)


def test_one_late_joint_is_named_alone(tmp_path):
    found = verdict(tmp_path, 400.0, (0.0, -9 * MS, 0.0))
    assert told(found).keys() == {"elbow"}
    delay = told(found)["elbow"]
    assert delay.low < -9 * MS < delay.high and delay.high - delay.low < 5 * MS


@pytest.mark.parametrize(("rate", "delay"), [(100.0, 0.0), (1000.0, 0.0), (100.0, 4 * MS)])
def test_no_delay_is_named_of_efforts_on_time_or_within_half_a_period(tmp_path, rate, delay):
    found = verdict(tmp_path, rate, (delay, delay, delay))
    assert {c.effect for c in found.causes} == {"coulomb_friction"}
