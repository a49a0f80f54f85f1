"""A servo with a top speed: large steps take longer, small ones do not show it."""

import numpy as np
import pytest
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from slides import servo

PERIOD, COUNT = 0.02, 1.534e-3
T = np.arange(0.0, 40.0, PERIOD)


def verdict_of(size, top):
    """A servo in counts, that goes 35 % of the way to its goal in each of its periods, at most `top` of them."""
    goal = np.round(size * np.sign(np.sin(0.5 * T)) * (1.0 + np.floor(T / 8.0) % 3))
    place, out = 0.0, []
    for asked in goal:
        out.append(round(place))
        place += float(np.clip(0.35 * (asked - place), -top, top))
    run = AxesRun("run", PERIOD, {"slide": {"position": COUNT * np.array(out), "reference": COUNT * goal}})
    return diagnose(servo(encoder_resolution=COUNT), [run]).verdict


def test_the_top_speed_of_a_servo_is_found():
    """26 counts in 20 ms: 1.99 rad/s."""
    verdict = verdict_of(600, 26.0)
    assert [c.effect for c in verdict.causes] == ["speed_limit"] and verdict.status == "attributed"
    found = verdict.causes[0].parameters
    assert found["limit"].value == pytest.approx(26.0 * COUNT / PERIOD, rel=0.02) and found["limit"].unit == "rad/s"


def test_a_servo_without_one_is_late():
    assert "speed_limit" not in [c.effect for c in verdict_of(600, 1e9).causes]
