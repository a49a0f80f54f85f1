"""The robot's plant behind the mock drives: what comes back over CAN is what the plant says, to the last count."""

import itertools

import numpy as np
import pytest
from sher3_description import load_robot
from sher3_drivers.bus.link import open_link
from sher3_drivers.mock.rig import LockstepRig
from sher3_drivers.settings import default_settings
from sher3_sim.plant import Plant

ROBOT = load_robot()
HALF_COUNTS = [2e-11, 2e-11, 2e-11, 6e-10, 2e-11]
_numbers = itertools.count()


@pytest.mark.parametrize("kind", ["virtual", "local"])
def test_the_wire_adds_nothing_but_its_rounding(kind, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    prefix = f"plant{next(_numbers)}"
    rig = LockstepRig(ROBOT, default_settings(), lambda i: open_link(f"{kind}:{prefix}-{i}"), Plant(ROBOT, seed=3))
    rig.enable()
    rng = np.random.default_rng(1)
    limits = np.array([a.limits.velocity for a in ROBOT.actuators])
    readings, step = [], rig.plant.step
    rig.plant.step = lambda command: readings.append(step(command)) or readings[-1]
    commands = np.cumsum(rng.uniform(-0.02, 0.02, (300, 5)), 0).clip(-1, 1) * limits
    previous = np.zeros(5)
    for command in commands:
        feedback, reading = rig.tick(list(command)), readings[-1]
        np.testing.assert_array_equal(feedback.load_position, reading.load_position)
        np.testing.assert_array_equal(feedback.motor_position, reading.motor_position)
        np.testing.assert_allclose(feedback.effort, reading.effort, rtol=1e-12, atol=1e-12)
        assert (np.abs(feedback.velocity_demand - previous) <= HALF_COUNTS).all()
        previous = command
    assert rig.driver.stop.reason is None and np.ptp([r.load_position for r in readings], axis=0).min() > 1e-4
    rig.close()
