"""Deflection compensation: the correction is the model's, and without a believable wrench there is none."""

from __future__ import annotations

import math

import numpy as np
import pytest
from law_bench import ROBOT
from sher3_control.errors import CommandRejected, SettingsError
from sher3_control.law.tool_compensation import tool_gravity
from sher3_control.motion.deflection import CorrectedPose, DeflectionCompensation
from sher3_control.settings import ControlSettings
from sher3_kinematics import RobotKinematics
from sher3_kinematics.tip_deflection import TipDeflection

PERIOD = round(ROBOT.control_period * 1e9)
SETTINGS = ControlSettings.from_robot(ROBOT, {"motion": {"deflection_compensation": True}})
Q = (1e-3, -2e-3, 5e-4, 0.2, 3e-3)
PLACE = RobotKinematics(ROBOT).transform_tip_to_base(Q)
POSE = CorrectedPose(10 * PERIOD, tuple(PLACE[:3, 3].tolist()), (0.0, 0.0, 0.0, 1.0))


def raw(force_in_tip: np.ndarray) -> np.ndarray:
    """Return what the sensor reads (6,) of a force at the tip, axes of {t}, and the tool's weight."""
    sensor, rotation = ROBOT.force_sensor, PLACE[:3, :3]
    weight = tool_gravity(tuple(rotation.ravel().tolist()), sensor.tool_mass, sensor.tool_com)
    moment = np.cross(-np.array(sensor.position), force_in_tip)
    return np.concatenate((force_in_tip, moment)) + np.array(weight)


def fed(wrench: np.ndarray, bias=(0.0,) * 6, ticks: int = 1) -> DeflectionCompensation:
    """Return a compensation that has seen a wrench, its last sample at tick 10; the last bits flicker as noise does."""
    compensation = DeflectionCompensation(ROBOT, SETTINGS)
    compensation.bias = bias
    for k in range(ticks):
        compensation.feed((11 - ticks + k) * PERIOD, tuple((wrench + 1e-12 * (k % 2)).tolist()))
    return compensation


def test_the_correction_is_the_models_deflection():
    force = np.array([0.5, -0.8, 0.6])
    place = fed(raw(force)).corrected("servo_cp", POSE, 10 * PERIOD, Q).position
    expected = TipDeflection(ROBOT)(Q, np.concatenate((PLACE[:3, :3] @ force, np.zeros(3))))[:3]
    assert np.array(POSE.position) - np.array(place) == pytest.approx(expected, rel=1e-6)
    assert np.linalg.norm(expected) > 1e-4


def test_an_unloaded_tool_is_not_corrected_whatever_weight_and_bias():
    bias = np.array([0.3, -0.2, 0.1, 2e-3, 1e-3, -1e-3])
    place = fed(raw(np.zeros(3)) + bias, tuple(bias.tolist())).corrected("servo_cp", POSE, 10 * PERIOD, Q).position
    assert np.array(place) == pytest.approx(np.array(POSE.position), abs=1e-10)
    other = fed(raw(np.zeros(3)) + bias).corrected("servo_cp", POSE, 10 * PERIOD, Q).position
    assert np.linalg.norm(np.array(other) - POSE.position) > 2e-5


def test_the_wrench_is_low_passed():
    """A step has come through by 1 - 1/e after 1 / (2 pi f)."""
    compensation, rest, loaded = fed(raw(np.zeros(3))), raw(np.zeros(3)), raw(np.array([0.0, 1.0, 0.0]))
    ticks = round(1.0 / (2.0 * math.pi * SETTINGS.motion.deflection_cutoff) / ROBOT.control_period)
    for k in range(ticks):
        compensation.feed((11 + k) * PERIOD, tuple((loaded + 1e-12 * (k % 2)).tolist()))
    assert (compensation.filtered[1] - rest[1]) == pytest.approx(1.0 - math.exp(-1.0), rel=0.02)


@pytest.mark.parametrize(
    ("make", "now", "reason"),
    [
        (lambda: DeflectionCompensation(ROBOT, SETTINGS), 10, "WRENCH_MISSING"),
        (lambda: fed(raw(np.zeros(3))), 17, "WRENCH_STALE"),
        (lambda: fed(np.full(6, np.nan)), 10, "WRENCH_NOT_FINITE"),
        (lambda: fed(np.array([13.0, 0, 0, 0, 0, 0])), 10, "WRENCH_OUT_OF_RANGE"),
        (lambda: fed(np.array([11.9, 0, 0, 0, 0, 0])), 10, "WRENCH_SATURATED"),
    ],
)
def test_no_correction_without_a_believable_wrench(make, now, reason):
    with pytest.raises(CommandRejected, match=reason):
        make().corrected("servo_cp", POSE, now * PERIOD, Q)


def test_a_frozen_sensor_is_refused():
    compensation = DeflectionCompensation(ROBOT, SETTINGS)
    for k in range(SETTINGS.wrench.frozen_samples):
        compensation.feed(k * PERIOD, tuple(raw(np.zeros(3)).tolist()))
    with pytest.raises(CommandRejected, match="WRENCH_FROZEN"):
        compensation.corrected("servo_cp", POSE, k * PERIOD, Q)


def test_a_position_that_is_no_number_is_refused():
    pose = POSE._replace(position=(math.nan, 0.0, 0.0))
    with pytest.raises(CommandRejected, match="finite"):
        fed(raw(np.zeros(3))).corrected("servo_cp", pose, 10 * PERIOD, Q)


def test_it_is_off_unless_asked_for_and_its_setting_is_checked():
    assert not ControlSettings.from_robot(ROBOT).motion.deflection_compensation
    with pytest.raises(SettingsError, match="deflection_cutoff"):
        ControlSettings.from_robot(ROBOT, {"motion": {"deflection_cutoff": 0.0}})
