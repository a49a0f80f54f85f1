"""The noise of the robot's sensors comes back from runs of its simulator, which knows it from robot.yaml."""

import numpy as np
import pytest
from sher3_description import ACTUATORS
from sher3_description.contract import EFFORT_NOISE, EFFORT_RESOLUTION
from sher3_gap.stages.noise import noise_of_sensors
from simulated import ROBOT, runs_of, signals

ROUND = np.sqrt(12.0)


@pytest.mark.parametrize("seed", [3, 11])
def test_noise_of_every_sensor_comes_back(seed):
    found = {
        (x.actuator, x.reading): x for x in noise_of_sensors(signals(runs_of(["sweep"], repeats=1, seed=seed)), ROBOT)
    }
    sensor = ROBOT.force_sensor
    truth = {
        ("force_sensor", "force"): np.hypot(sensor.noise_force, sensor.resolution_force / ROUND),
        ("force_sensor", "torque"): np.hypot(sensor.noise_torque, sensor.resolution_torque / ROUND),
        ("tip", "position"): ROBOT.tracker.noise_position,
    }
    for name, a in zip(ACTUATORS, ROBOT.actuators, strict=True):
        truth[name, "motor"], truth[name, "load"] = a.motor_encoder / ROUND, a.load_encoder / ROUND
        truth[name, "effort"] = a.drive.rated * np.hypot(EFFORT_NOISE, EFFORT_RESOLUTION / ROUND)
    assert {key: x.deviation for key, x in found.items()} == pytest.approx(truth, rel=0.1)
    assert found["roll", "motor"].unit == "rad" and found["delta_1", "effort"].unit == "N"
    assert found["tip", "position"].resolution is None
