"""Signals of one axis: the residual grid of fast and slow records, and the force that acts."""

import numpy as np
import pytest
from sher3_chain.joint.record import AxesRun
from sher3_chain.readings.signals import AxisSignals, held_mean, signals_of
from sher3_diagnosis.filter import BANDWIDTH
from slides import axis_of, columns


def straight(period, n=400, speed=0.1):
    return AxisSignals("run", "run", period, speed * period * np.arange(n)[:, None])


def test_a_fast_record_is_judged_at_a_hundred_hertz():
    fast = straight(0.002)
    assert (fast.stride, fast.rate, list(fast.grid[:3])) == (5, 100.0, [0, 5, 10])
    assert fast.bandwidth == BANDWIDTH
    assert list(np.flatnonzero(fast.inner)[[0, -1]] * 5) == [25, 370]  # 0.05 s at either end


def test_a_slow_record_keeps_every_sample_and_a_lower_cut_off():
    """At 50 Hz the Nyquist rate is 25 Hz: the cut-off is 10 Hz, and 2.5 samples per period of it are 25 Hz."""
    run = AxesRun("run", 0.02, {"slide": {"position": np.zeros(200), "reference": np.zeros(200)}})
    slow = signals_of(run, axis_of(signals=columns("position", "reference"), command_law={"kind": "position"}), "run")
    assert (slow.bandwidth, slow.stride, slow.rate) == (pytest.approx(10.0), 2, pytest.approx(25.0))


def test_velocity_and_acceleration_of_a_parabola():
    clock = 0.01 * np.arange(100)
    run = AxisSignals("run", "run", 0.01, (0.5 * 3.0 * clock**2)[:, None])
    assert run.acceleration[1:-1] == pytest.approx(3.0)
    assert run.velocity[50, 0] == pytest.approx(3.0 * 0.5, rel=1e-3)
    assert run.ticks == 100 and run.stage_clock[-1] == pytest.approx(0.99)


def test_the_force_is_measured_commanded_or_none():
    """A command of 2 V at 3 N/V is 6 N; held from sample to sample its mean lags by half a period."""
    signals = {"position": np.zeros(100), "reference": np.zeros(100), "command": np.r_[0.0, np.full(99, 2.0)]}

    def force(found, **law):
        axis = axis_of(command_law={"kind": "force", "gain": 3.0, **law})
        return signals_of(AxesRun("run", 0.01, {"slide": found}), axis, "run").effort

    assert force(signals)[:3, 0].tolist() == [0.0, 6.0, 6.0]
    assert force(signals, held=True)[:3, 0].tolist() == [0.0, 3.0, 6.0]
    assert force({**signals, "effort": np.full(100, 5.0)})[0, 0] == 5.0
    free = axis_of(command_law={"kind": "none"}, signals=columns("position"))
    assert not signals_of(AxesRun("run", 0.01, {"slide": {"position": np.ones(100)}}), free, "run").effort.any()


def test_the_mean_of_a_held_command():
    assert held_mean(np.array([[1.0], [3.0], [3.0]])).ravel().tolist() == [1.0, 2.0, 3.0]
