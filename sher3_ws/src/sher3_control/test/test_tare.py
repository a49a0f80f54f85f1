"""Tare: the true bias at any orientation, every refusal by its reason, and the drift of the resting wrench."""

import math

import numpy as np
import pytest
from law_bench import ROBOT, SETTINGS
from sher3_control.errors import TareRefused
from sher3_control.law.tare import DriftMonitor, TareWindow
from sher3_control.law.tool_compensation import tip_rotation, tool_gravity

BIAS = np.array([0.3, -0.5, 0.8, 0.004, -0.002, 0.001])
ZERO = (0.0,) * 6
T = 2_000_000


def window(n=None, noise=0.003, roll=0.4, tilt=-0.6, moving=0.0, bias=BIAS, spoil=None):
    rng = np.random.default_rng(5)
    result = TareWindow(ROBOT, SETTINGS.tare)
    weight = np.array(tool_gravity(tip_rotation(roll, tilt), ROBOT.force_sensor.tool_mass, ROBOT.force_sensor.tool_com))
    count = SETTINGS.tare.samples if n is None else n
    for k in range(count):
        wrench = weight + bias + rng.normal(0.0, noise * np.repeat([1.0, 0.007], 3))
        if spoil is not None and k == count // 2:
            wrench[2] = spoil
        result.feed(k * T, tuple(wrench.tolist()), (moving * k / count,) * 5, roll, tilt)
    return result, (count - 1) * T


def ask(case, pressed=False, late=0):
    target, now = case
    return target.tare(pressed, now + late, 10_000_000, ZERO)


@pytest.mark.parametrize(("roll", "tilt"), [(0.0, 0.0), (0.7, 0.3), (-0.5, -1.0)])
def test_the_bias_is_found_at_any_orientation_with_its_residual(roll, tilt):
    result = ask(window(roll=roll, tilt=tilt))
    assert np.all(np.abs(np.array(result.bias) - BIAS) <= 5.0 * np.array(result.residual))
    assert result.residual[0] == pytest.approx(0.003 / math.sqrt(result.samples), rel=0.2)
    assert result.change == result.bias


@pytest.mark.parametrize(
    ("reason", "case", "options"),
    [
        ("pressed", {}, {"pressed": True}),
        ("samples", {"n": 20}, {}),
        ("samples", {}, {"late": 20_000_000}),
        ("moving", {"moving": 1e-4}, {}),
        ("noisy", {"noise": 0.05}, {}),
        ("faulty", {"spoil": math.nan}, {}),
        ("faulty", {"noise": 0.0}, {}),
        ("too_large", {"bias": BIAS * 10.0}, {}),
    ],
)
def test_every_refusal_names_its_reason_and_a_remedy(reason, case, options):
    with pytest.raises(TareRefused) as caught:
        ask(window(**case), **options)
    assert caught.value.reason == reason
    assert caught.value.remedy


def test_drift_is_known_after_a_rest_and_reported_beyond_its_limit():
    monitor = DriftMonitor(SETTINGS.tare, 0.002)
    small = (0.01, 0.0, 0.0, 0.0, 0.0, 0.0)
    for _ in range(499):
        monitor.feed(small)
    assert monitor.drift is None
    assert not monitor.exceeded()
    monitor.feed(small)
    assert monitor.drift == pytest.approx(small)
    assert not monitor.exceeded()
    for _ in range(2000):
        monitor.feed((0.1, 0.0, 0.0, 0.0, 0.0, 0.0))
    assert monitor.exceeded()
    monitor.reset()
    assert monitor.drift is None
