"""A force that follows the recorded effort late: a propeller behind a voltage, a chamber behind a valve."""

import numpy as np
import pytest
from scipy.signal import lfilter
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from slides import columns, machine

FINE = 1e-3


def swung(lag=0.0, delay=0.0, seed=0, rate=100, viscous=0.05, dry=0.05, weight=1.5, mass=0.02, unit="V"):
    """An arm that hangs in bearings and is lifted by a force that comes late; steps of a random size drive it."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 40.0, FINE)
    asked = np.repeat(rng.uniform(-1.2, 1.2, 80), 500)
    acts = np.interp(t - delay, t, asked)
    if lag:
        share = 1.0 - np.exp(-FINE / lag)
        acts = lfilter([share], [1.0, share - 1.0], acts)
    q, v, place = 0.0, 0.0, np.empty(len(t))
    rub = FINE / mass * dry
    for k, force in enumerate(acts.tolist()):
        place[k] = q
        free = v + FINE / mass * (force - weight * float(np.sin(q)) - viscous * v)
        v = free - min(max(free, -rub), rub)
        q += FINE * v
    every = 1000 // rate
    count = 2.0 * np.pi / 4096
    position = count * np.round(place[::every] / count)
    effort = asked[::every] + 0.005 * rng.normal(size=len(position))
    run = AxesRun("run", 1.0 / rate, {"slide": {"position": position, "effort": effort}})
    signals = {**columns("position", unit="rad"), **columns("effort", unit=unit)}
    law = {"motion": "rotary", "mass": "unknown", "command_law": {"kind": "force"}}
    return diagnose(machine(signals=signals, encoder_resolution=count, **law), [run]).verdict


def found(verdict):
    return {c.effect: c.parameters for c in verdict.causes}


@pytest.mark.parametrize(("lag", "rate"), [(0.05, 100), (0.12, 50), (0.2, 200)])
def test_a_force_that_comes_late_is_a_lag_of_the_drive(lag, rate):
    """Beside a weight, within half a period: what was told acts until the next sample."""
    causes = found(swung(lag=lag, rate=rate))
    assert "sensor_delay" not in causes
    time = causes["drive_lag"]["time_constant"]
    assert time.low - 0.5 / rate <= lag <= time.high and time.value == pytest.approx(lag, rel=0.25)
    assert causes["gravity_load"]["arm"].value == pytest.approx(1.5, rel=0.1)


def test_a_dead_time_is_one():
    assert found(swung(delay=0.1))["drive_lag"]["delay"].value == pytest.approx(0.105, abs=0.01)


@pytest.mark.parametrize("weight", [0.0, 1.5])
def test_a_force_that_comes_at_once_has_no_lag(weight):
    assert "drive_lag" not in found(swung(weight=weight, viscous=0.15))


@pytest.mark.parametrize("unit", ["N*m", "%", "1"])
def test_a_recorded_force_has_no_lag(unit):
    """What was measured as a force is the force, in whatever unit: an early reading stays one of the recorder."""
    assert "drive_lag" not in found(swung(lag=0.12, unit=unit))


def drawn(seed):
    """An arm or a motor of random size, and its lag; of none in some."""
    g = np.random.default_rng(900 + seed)
    lag = float(g.choice([0.0, np.exp(g.uniform(np.log(0.03), np.log(0.2)))]))
    weight, viscous = float(g.choice([0.0, 1.5])), float(g.uniform(0.05, 0.3))
    sizes = {"rate": int(g.choice([50, 100, 200])), "dry": float(g.uniform(0.0, 0.1))}
    mass = float(np.exp(g.uniform(np.log(0.01), np.log(0.05))))
    return {"seed": seed, "lag": lag, "weight": weight, "viscous": viscous, "mass": mass, **sizes}


@pytest.mark.slow
def test_drawn_lags_are_told_and_none_where_none_is():
    missed = 0
    for machine_of in map(drawn, range(14)):
        told = found(swung(**machine_of)).get("drive_lag")
        assert bool(told) == bool(machine_of["lag"])
        if told:
            time, held = told["time_constant"], 0.5 / machine_of["rate"]
            missed += not time.low - held <= machine_of["lag"] <= time.high
    assert missed <= 1
