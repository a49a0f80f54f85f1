"""Servos that are told a speed: where their position counts from is no gap, and their lag is found all the same."""

import numpy as np
import pytest
from sher3_chain.joint.record import axes_run
from sher3_diagnosis import diagnose
from slides import described, machine

PERIOD, LAG = 0.005, 0.06
SPEED = {
    "motion": "rotary",
    "signals": {"position": {"column": "q", "unit": "rad"}, "reference": {"column": "w", "unit": "rad/s"}},
    "command_law": {"kind": "position"},
    "mass": None,
    "encoder_resolution": 1e-4,
}


def table(zero, seed):
    """A speed that is followed with a lag of first order, from any place on."""
    rng, n = np.random.default_rng(seed), 2400
    t = PERIOD * np.arange(n)
    asked = 3.0 * np.sin(1.1 * t + seed) + 2.0 * np.sign(np.sin(0.8 * t + 0.5))
    speed, place, rows = 0.0, zero, np.empty(n)
    for k in range(n):
        rows[k] = place
        for _ in range(5):
            speed += PERIOD / 5 * (asked[k] - speed) / LAG
            place += PERIOD / 5 * speed
    return {"t": t, "q": np.round((rows + 2e-5 * rng.normal(size=n)) / 1e-4) * 1e-4, "w": asked}


@pytest.mark.parametrize("zeros", [(0.0, 0.0), (2.4, -3.7)])
def test_a_lag_is_found_whatever_the_positions_count_from(zeros):
    runs = [axes_run(f"run{k}", table(zero, k), described(**SPEED)) for k, zero in enumerate(zeros)]
    verdict = diagnose(machine(**SPEED), runs).verdict
    assert verdict.status == "attributed" and [c.effect for c in verdict.causes] == ["drive_lag"]
    found = verdict.causes[0].parameters
    late = found["time_constant"].value + (found["delay"].value if "delay" in found else 0.0)
    assert late == pytest.approx(LAG, rel=0.1)


@pytest.mark.parametrize("fastest", [3.0, 900.0])
def test_the_sum_of_a_speed_has_no_counter(fastest):
    """A wheel at 200 Hz that turns by more than half a turn a sample, or hardly: its place is the sum, to the end."""
    t = PERIOD * np.arange(2000)
    speed = fastest * np.sign(np.sin(1.3 * t)) * (1.0 - np.exp(-((1.3 * t) % np.pi)))
    axis = {**SPEED, "signals": {"position": {"column": "w", "unit": "rad/s"}}, "command_law": {"kind": "none"}}
    run = axes_run("run", {"t": t, "w": speed}, described(**axis))
    assert not [note for note in run.notes if "wraps" in note]
    place = run.signals["slide"]["position"]
    assert np.diff(place) == pytest.approx(0.5 * PERIOD * (speed[1:] + speed[:-1]), abs=1e-9 * fastest)
