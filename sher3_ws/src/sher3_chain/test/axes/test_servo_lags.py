"""Delay and lag of a servo together, and a load that rings behind a second encoder."""

import numpy as np
import pytest
from drawn_axes import drawn_servo
from scipy.signal import lfilter
from sher3_chain.axes.causes.confounded_laws import with_second_pole
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from sher3_diagnosis.verdict import Cause, Interval, Parameter
from slides import columns, machine, servo

COUNT = 1e-4


def test_delay_and_lag_are_told_together():
    """30 ms and 60 ms; within half a period of 10 ms nobody states when a set-point acts."""
    period = 0.01
    t = np.arange(0.0, 40.0, period)
    asked = 0.4 * np.sin(0.9 * t) + 0.1 * np.sin(4.7 * t) + 0.2 * np.sign(np.sin(0.37 * t))
    fine = np.arange(0.0, 40.0, 0.1 * period)
    keep = np.exp(-0.1 * period / 0.06)
    place = lfilter([1.0 - keep], [1.0, -keep], np.interp(fine - 0.03, t, asked))[::10]
    run = AxesRun("run", period, {"slide": {"position": COUNT * np.round(place / COUNT), "reference": asked}})
    verdict = diagnose(servo(encoder_resolution=COUNT), [run]).verdict
    assert [c.effect for c in verdict.causes] == ["drive_lag"]
    found = verdict.causes[0].parameters
    assert found["time_constant"].value == pytest.approx(0.06, rel=0.03)
    assert found["delay"].value == pytest.approx(0.03, abs=0.007)


@pytest.mark.parametrize("rate", [50, 200])
@pytest.mark.parametrize("seed", range(3))
def test_a_dead_time_alone_is_no_lag(seed, rate):
    """Between the delays that are tried a lag and an inertia made up the rest: of 36 drawn servos 14 had a lag."""
    rng = np.random.default_rng([seed, rate])
    t = np.arange(0.0, 20.0, 1.0 / rate)
    asked = rng.uniform(0.2, 0.6) * np.sin(rng.uniform(0.6, 1.5) * t) + 0.1 * np.sin(rng.uniform(3.0, 8.0) * t)
    asked += 0.3 * np.repeat(rng.uniform(-1.0, 1.0, 20), rate)
    rows = int(rng.integers(2, 11))
    place = np.concatenate([np.full(rows, asked[0]), asked[:-rows]]) + COUNT * rng.normal(size=len(t))
    run = AxesRun("run", 1.0 / rate, {"slide": {"position": COUNT * np.round(place / COUNT), "reference": asked}})
    (cause,) = diagnose(servo(encoder_resolution=COUNT), [run]).verdict.causes
    assert cause.effect == "command_delay"
    assert cause.parameters["delay"].value == pytest.approx(rows / rate, rel=0.02)


def test_a_load_that_rings_tells_its_frequency_without_a_force():
    """12 Hz and a damping of 0.08, shaken by a sweep to 20 Hz."""
    period, pace = 0.002, 2.0 * np.pi * 12.0
    t = np.arange(0.0, 20.0, period)
    motor = 0.05 * np.sin(2.1 * t) + 0.01 * np.sin(2.0 * np.pi * (2.0 + 0.45 * t) * t)
    x, v, load = motor[0], 0.0, []
    for k, start in enumerate(motor):
        load.append(x)
        end = motor[min(k + 1, len(motor) - 1)]
        for part in np.arange(20) / 20.0:
            v += (
                period
                / 20.0
                * (pace**2 * (start + part * (end - start) - x) + 0.16 * pace * ((end - start) / period - v))
            )
            x += period / 20.0 * v
    signals = {"position": 1e-6 * np.round(1e6 * motor), "load": 1e-6 * np.round(1e6 * np.array(load)) + 0.02}
    law = {"mass": None, "command_law": {"kind": "none"}, "encoder_resolution": 1e-6}
    verdict = diagnose(
        machine(signals=columns("position", "load"), **law), [AxesRun("run", period, {"slide": signals})]
    ).verdict
    assert [c.effect for c in verdict.causes] == ["transmission_compliance"]
    assert verdict.causes[0].parameters["frequency"].value == pytest.approx(12.0, rel=0.02)


@pytest.mark.parametrize("seed", [8004, 8020, 8070, 8127])
def test_a_dead_time_beside_a_lag_and_a_friction_is_told(seed):
    """Drawn servos of 100 and 50 Hz, 30 and 80 ms late: half a period more, since they hold what they are asked.

    Before, two numbers of the lag changed places, so that neither had a size. The mass of the servo, which counts hide,
    makes the dead time longer: 8004 and 8127, at 200 Hz and 100 Hz.
    """
    drawn = drawn_servo(seed)
    causes = {c.effect: c for c in diagnose(drawn.machine, [drawn.run]).verdict.causes}
    assert set(causes) == {*drawn.truth} - {"delay"}
    delay = causes["drive_lag"].parameters["delay"]
    assert delay.low < drawn.late + 0.5 * drawn.run.period < delay.high


def test_a_dead_time_may_be_the_second_pole_of_a_lag():
    """Of 56 ms beside a lag of 75 ms 25 ms may be a pole; 10 ms where an inertia of 15 ms * 75 ms is told by itself."""
    told = {n: Parameter(value=x, low=x, high=x, unit="s") for n, x in (("time_constant", 0.075), ("delay", 0.056))}
    seen = {"inertia": Parameter(value=0.075 * 0.015, low=0.0, high=0.01, unit="s^2")}
    lag = Cause(
        effect="drive_lag", family="timing", stage="drive", actuator="a", closure=Interval(value=1.0), parameters=told
    )
    (alone,) = with_second_pole([lag])
    (beside,) = with_second_pole([lag.model_copy(update={"parameters": {**told, **seen}})])
    for found, pole in ((alone, 0.025), (beside, 0.010)):
        lag_of, delay = found.parameters["time_constant"], found.parameters["delay"]
        assert (lag_of.low, lag_of.high) == pytest.approx((0.075, 0.075 + pole))
        assert (delay.low, delay.high) == pytest.approx((0.056 - pole, 0.056))


def test_no_number_of_a_servo_is_below_zero():
    """A slope of the error that would make a loop later is a dead time: drawn at 200 Hz, 10 ms late."""
    drawn = drawn_servo(8004)
    causes = {c.effect: c for c in diagnose(drawn.machine, [drawn.run]).verdict.causes}
    assert "delay" in causes["drive_lag"].parameters and "rate" not in causes["drive_lag"].parameters
