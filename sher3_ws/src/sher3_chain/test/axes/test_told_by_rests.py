"""A weight at an arm under a servo that goes from place to place: its rests tell it, the way between them does not."""

import numpy as np
import pytest
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from slides import columns, machine

STEP, FINER = 0.002, 10


def verdict_of(angle, arm, count, lag, top=10.0):
    """A servo told an angle, deg: a lag, a top speed, rad/s, 30 ms dead, and a weight at an arm, rad."""
    t = np.arange(0.0, 2.4, STEP)
    asked = np.where(t > 0.6, np.radians(angle), 0.0)
    q = v = 0.0
    place = np.zeros(len(t))
    for k in range(len(t)):
        for _ in range(FINER):
            pace = np.clip((asked[max(k - 15, 0)] - arm * np.sin(q) - q) / lag, -top, top)
            v += STEP / FINER * (pace - v) / 0.01
            q += STEP / FINER * v
        place[k] = q
    read = np.radians(count) * np.floor(place / np.radians(count) + 1e-6)
    run = AxesRun("run", STEP, {"slide": {"position": read, "reference": asked}})
    law = {"motion": "rotary", "command_law": {"kind": "position"}, "encoder_resolution": np.radians(count)}
    return diagnose(machine(signals=columns("position", "reference", unit="rad"), **law), [run]).verdict


@pytest.mark.parametrize(("lag", "top"), [(0.03, 10.0), (0.06, 6.0), (0.06, 10.0), (0.1, 6.0), (0.1, 10.0)])
def test_a_step_of_180_degrees_tells_no_weight(lag, top):
    """It rests where a weight at an arm does nothing; a weight of 1 rad took the place of its top speed."""
    assert all(cause.effect != "gravity_load" for cause in verdict_of(180.0, 0.0, 20.0, lag, top).causes)


def test_a_servo_that_rests_beside_its_reference_tells_its_weight():
    verdict = verdict_of(45.0, 0.3, 0.1, 0.05)
    arm = next(cause.parameters["arm"] for cause in verdict.causes if cause.effect == "gravity_load")
    assert arm.value == pytest.approx(0.3, rel=0.1)
