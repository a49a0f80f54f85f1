"""Servos that are told a speed: where their position counts from is no gap, and their lag is found all the same."""

import numpy as np
import pytest
from sher3_chain.joint.record import axes_run
from sher3_diagnosis import diagnose
from sher3_machines import MachineError
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


def test_a_table_of_speeds_in_both_senses_is_no_record_in_time():
    speeds = np.repeat(np.linspace(0.01, 0.3, 40), 2) * np.tile([1.0, -1.0], 40)
    axis = {**SPEED, "signals": {"position": {"column": "w", "unit": "rad/s"}}, "command_law": {"kind": "none"}}
    with pytest.raises(MachineError, match=r"turns back at every row.*give the record that the table was made of"):
        axes_run("map", {"t": 0.1 * np.arange(80), "w": speeds}, described(**axis))


def test_the_noise_of_a_speed_at_rest_is_one():
    axis = {**SPEED, "signals": {"position": {"column": "w", "unit": "rad/s"}}, "command_law": {"kind": "none"}}
    noise = np.random.default_rng(3).normal(size=300)
    assert axes_run("rest", {"t": 0.1 * np.arange(300), "w": noise}, described(**axis)).ticks == 300


WHEEL = {**SPEED, "signals": {name: {"column": name, "unit": "rad/s"} for name in ("position", "reference")}}


def wheel(seed, integral, most=1e9, steady=False):
    """A wheel with viscous friction under a PI loop of its speed, at 100 Hz, read in counts of 0.1 rad/s."""
    rng, t = np.random.default_rng(seed), 0.01 * np.arange(3000)
    levels = rng.uniform(2.0, 12.0, 12) * np.where(np.arange(12) % 3 == 2, -1.0, 1.0)
    asked = np.repeat([10.0] * 12 if steady else levels, 250)
    speed = total = 0.0
    read = np.empty(len(t))
    for k, want in enumerate(asked):
        read[k] = speed
        drive = np.clip(4.0 * (want - speed) + total, -most, most)
        total += 0.01 * integral * (want - speed) * (abs(drive) < most)
        speed += 0.01 * (drive - 0.8 * speed) / 0.15
    read = np.round((read + 0.1 * rng.normal(size=len(t))) / 0.1) * 0.1
    return {"t": t, "position": read, "reference": asked}


@pytest.mark.parametrize("steady", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_a_loop_without_an_integral_part_stays_behind_by_a_share(seed, steady):
    """4 / 4.8 of what is asked: 16.7 % less, at one speed or at twelve."""
    run = axes_run("run", wheel(seed, 0.0, steady=steady), described(**WHEEL))
    causes = {c.effect: c for c in diagnose(machine(**WHEEL), [run]).verdict.causes}
    share = causes["reference_scale"].parameters["relative"]
    assert share.value == pytest.approx(-0.8 / 4.8, rel=0.03)
    assert causes.keys() <= {"reference_scale", "drive_lag"}


@pytest.mark.parametrize("seed", range(3))
def test_a_loop_with_one_has_no_share(seed):
    run = axes_run("run", wheel(seed, 20.0), described(**WHEEL))
    assert not {"reference_scale", "speed_limit"} & {c.effect for c in diagnose(machine(**WHEEL), [run]).verdict.causes}


@pytest.mark.parametrize("seed", range(3))
def test_a_wheel_that_reaches_slow_speeds_alone_has_a_top_speed(seed):
    """A drive of 5.6 N m at most turns it at 7 rad/s; what it misses it does not catch up with."""
    run = axes_run("run", wheel(seed, 20.0, most=5.6), described(**WHEEL))
    causes = {c.effect: c for c in diagnose(machine(**WHEEL), [run]).verdict.causes}
    assert causes["speed_limit"].parameters["limit"].value == pytest.approx(7.0, rel=0.05)
    assert "reference_scale" not in causes


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
