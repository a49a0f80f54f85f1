"""Late readings: a delay is a cause of its own, and no lost motion; lost motion is no delay."""

import numpy as np
import pytest
from sher3_chain.joint.record import AxesRun
from sher3_chain.readings.wrong import wrong_readings
from sher3_diagnosis import diagnose
from sher3_machines import MachineError
from slides import axis_of, columns, machine

PERIOD, COUNT = 0.001, 1e-6
T = np.arange(0.0, 16.0, PERIOD)
LOADED = {"signals": columns("position", "load"), "mass": None, "command_law": {"kind": "none"}}


def moved(t):
    return 0.05 * np.sin(1.6 * t) + 0.02 * np.sin(4.4 * t + 0.3)


def verdict_of(load, position=None, **changes):
    position = moved(T) if position is None else position
    run = AxesRun("run", PERIOD, {"slide": {"position": position, "load": load}})
    return diagnose(machine(**{**LOADED, **changes}), [run]).verdict


@pytest.mark.parametrize("delay", [3.0e-3, 2.7e-3, -3.0e-3])
@pytest.mark.parametrize("noise", [0.0, 20e-6])
@pytest.mark.parametrize("lead", [None, 0.005])
def test_a_late_second_encoder_is_late_and_has_no_lost_motion(delay, noise, lead):
    rng = np.random.default_rng(0)
    position, load = (x + noise * rng.normal(size=len(T)) for x in (moved(T), moved(T - delay)))
    verdict = verdict_of(load, position, lead=lead)
    assert [c.effect for c in verdict.causes] == ["sensor_delay"] and verdict.status == "attributed"
    found = verdict.causes[0].parameters["load_delay"]
    assert found.value == pytest.approx(delay, rel=0.02) and found.unit == "s"
    assert not {"backlash", "transmission_hysteresis"} & set(verdict.causes[0].rivals)


def test_backlash_is_no_delay():
    side, load = moved(T[:1])[0], np.empty_like(T)
    for k, x in enumerate(moved(T)):
        side = min(max(side, x - 1e-4), x + 1e-4)
        load[k] = COUNT * round(side / COUNT)
    verdict = verdict_of(load)
    assert [c.effect for c in verdict.causes] == ["backlash"]
    assert "sensor_delay" not in verdict.causes[0].rivals


def test_backlash_behind_a_late_encoder_is_both():
    side, load = moved(T[:1])[0], np.empty_like(T)
    for k, x in enumerate(moved(T - 3e-3)):
        side = min(max(side, x - 1e-4), x + 1e-4)
        load[k] = COUNT * round(side / COUNT)
    assert {c.effect for c in verdict_of(load).causes} == {"backlash", "sensor_delay"}


@pytest.mark.parametrize("delay", [8e-3, 5e-3])
def test_a_late_effort_is_late_and_no_mass_or_friction(delay):
    """12 kg shaken at up to 2.5 Hz, 5 N of friction: the effort needed a moment ago is recorded."""
    mass, waves = 12.0, ((0.03, 3.0, 0.0), (0.01, 9.0, 1.0), (0.004, 16.0, 2.0))
    q, a = (sum(k(s, w, p) for s, w, p in waves) for k in (_place, _acceleration))
    late = T - delay
    force = mass * sum(_acceleration(s, w, p, late) for s, w, p in waves)
    force += 5.0 * np.tanh(sum(s * w * np.cos(w * late + p) for s, w, p in waves) / 1e-4)
    assert mass * a.std() > 10.0
    noise = 0.05 * np.random.default_rng(0).normal(size=len(T))
    run = AxesRun("run", PERIOD, {"slide": {"position": COUNT * np.round(q / COUNT), "effort": force + noise}})
    signals = {**columns("position"), **columns("effort", unit="N")}
    verdict = diagnose(machine(signals=signals, mass=mass, command_law={"kind": "force"}), [run]).verdict
    causes = {c.effect: c for c in verdict.causes}
    assert "sensor_delay" in causes and {c.family for c in verdict.causes} == {"timing", "friction"}
    assert causes["sensor_delay"].parameters["effort_delay"].value == pytest.approx(delay, rel=0.1)
    assert causes["coulomb_friction"].parameters["force"].value == pytest.approx(5.0, rel=0.1)


@pytest.mark.parametrize("width", [2e-3, 2e-2])
@pytest.mark.parametrize("periods", [0.0, 0.4])
def test_a_smooth_friction_is_no_late_effort(width, periods):
    """8 N that turn over a few mm/s, sampled at 100 Hz with a noisy encoder; the effort is late by less than half."""
    period, rng = 0.01, np.random.default_rng(3)
    t = np.arange(0.0, 20.0, period)
    late, waves = t - periods * period, ((0.04, 1.3, 0.2), (0.01, 5.1, 0.4))
    speed = sum(s * w * np.cos(w * late + p) for s, w, p in waves)
    force = 3.0 * sum(_acceleration(s, w, p, late) for s, w, p in waves) + 8.0 * np.tanh(speed / width) + 2.0 * speed
    place = sum(_place(s, w, p, t) for s, w, p in waves) + 1e-5 * rng.normal(size=len(t))
    run = AxesRun("run", period, {"slide": {"position": place, "effort": force + 0.1 * rng.normal(size=len(t))}})
    signals = {**columns("position"), **columns("effort", unit="N")}
    verdict = diagnose(machine(signals=signals, mass="unknown", command_law={"kind": "force"}), [run]).verdict
    assert {c.family for c in verdict.causes} == {"friction"}


def _place(size, pace, phase, t=T):
    return size * np.sin(pace * t + phase)


def _acceleration(size, pace, phase, t=T):
    return -size * pace**2 * np.sin(pace * t + phase)


def test_another_scale_is_named_and_no_lead_error():
    run = AxesRun("run", PERIOD, {"slide": {"position": moved(T), "load": 0.5 * moved(T)}})
    assert "moves 0.5 times as far" in wrong_readings(run, axis_of(**LOADED))["load"]
    with pytest.raises(MachineError, match=r"moves 0.5 times as far"):
        verdict_of(0.5 * moved(T))
