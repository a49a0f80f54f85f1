"""Two encoders whose zeros differ, that warm up, or of which the load's is off centre; springs behind play."""

import numpy as np
import pytest
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from slides import columns, machine, servo

PERIOD, COUNT = 0.01, 1e-6
T = np.arange(0.0, 60.0, PERIOD)
FREE = {"mass": None, "command_law": {"kind": "none"}, "encoder_resolution": COUNT}


def read(x, seed=0):
    return COUNT * np.round((x + 2e-6 * np.random.default_rng(seed).normal(size=len(x))) / COUNT)


def effects(verdict):
    return [c.effect for c in verdict.causes]


def verdict_of(position, load, motion="linear", **more):
    unit = "m" if motion == "linear" else "rad"
    signals = columns("position", "load", unit=unit) | {k: {"column": k, "unit": "degC"} for k in more}
    run = AxesRun("run", PERIOD, {"slide": {"position": read(position), "load": read(load, 1), **more}})
    return diagnose(machine(signals=signals, motion=motion, **FREE), [run]).verdict


def test_another_zero_is_no_gap():
    """No two encoders of a robot read the same at the same place."""
    place = 0.05 * np.sin(1.3 * T)
    assert verdict_of(place, place + 0.0123).status == "no_gap"


def test_a_screw_that_grows_with_its_nut_s_temperature():
    place, warm = 0.15 * (1.0 - np.cos(0.4 * T)), 21.0 + 9.0 * (1.0 - np.exp(-T / 20.0))
    verdict = verdict_of(place, place * (1.0 + 60e-6 * (warm - 20.0)), temperature=warm)
    assert effects(verdict) == ["thermal_expansion"]
    found = verdict.causes[0].parameters["coefficient"]
    assert found.value == pytest.approx(60e-6, rel=0.05) and found.unit == "1/K"


def test_the_eccentricity_of_a_load_that_turns_needs_no_lead():
    place = 0.35 * T * np.sign(30.0 - T) + 21.0 * (T > 30.0)
    verdict = verdict_of(place, place + 5e-4 * np.sin(place + 0.9), motion="rotary")
    assert effects(verdict) == ["encoder_eccentricity"]
    assert verdict.causes[0].parameters["amplitude"].value == pytest.approx(5e-4, rel=0.03)


@pytest.mark.parametrize("play", [0.0, 5e-3, 2e-2])
def test_a_spring_behind_play_keeps_its_stiffness_under_a_known_load(play):
    """A held axis, 25 N to and fro, 2000 N/m. The published miss: 4190."""
    load = 25.0 * np.sin(0.5 * T) * np.sin(0.09 * T + 0.5)
    bent = load / 2000.0 + 0.5 * play * np.sign(load) + 0.12
    signals = columns("position", "reference", "load") | columns("applied", unit="N")
    still = np.zeros_like(T)
    run = AxesRun(
        "run", PERIOD, {"slide": {"position": still, "reference": still, "load": read(bent), "applied": load}}
    )
    found = {
        c.effect: c.parameters
        for c in diagnose(servo(signals=signals, motion="linear", encoder_resolution=COUNT), [run]).verdict.causes
    }
    assert set(found) == {"transmission_compliance", *(["backlash"] if play else [])}
    assert found["transmission_compliance"]["stiffness"].value == pytest.approx(2000.0, rel=0.02)
    if play:
        assert found["backlash"]["width"].value == pytest.approx(play, rel=0.05)


def test_an_axis_that_is_let_go_is_not_moved_by_its_noise():
    """A pendulum held for a second at 65 degrees, read with 1.4 mrad of noise, and stated to count 0.1 mrad."""
    q, v, out = np.deg2rad(65.0), 0.0, []
    clock = np.arange(0.0, 25.0, PERIOD)
    for t in clock:
        out.append(q)
        for _ in range(10):
            if t >= 1.0:
                v += 1e-3 * (-1.35 * np.sin(q) - 0.03 * v) / 0.042
                q += 1e-3 * v
    noisy = np.array(out) + 1.4e-3 * np.random.default_rng(0).normal(size=len(clock))
    run = AxesRun("run", PERIOD, {"slide": {"position": noisy}})
    law = {"motion": "rotary", "mass": 0.042, "gravity": {"arm": 1.35}, "encoder_resolution": 1e-4}
    pendulum = machine(signals=columns("position", unit="rad"), command_law={"kind": "none"}, **law)
    verdict = diagnose(pendulum, [run]).verdict
    assert effects(verdict) == ["viscous_friction"]
    found = verdict.causes[0].parameters["extra"]
    assert found.low <= 0.03 <= found.high and verdict.closure.tip.value > 0.9


def test_short_runs_are_judged_together():
    """Twelve records of 20 samples at 20 Hz; the published miss: 1.0 N m of dry friction not found."""
    rng, runs = np.random.default_rng(12), []
    fine = np.arange(0.0, 1.0, 2e-4)
    for k in range(12):
        size, pace, phase = 0.2 + 0.3 * rng.random(), 2.0 * np.pi * (0.7 + 0.8 * rng.random()), 6.0 * rng.random()
        q = size * np.sin(pace * fine + phase)
        v = np.gradient(q, fine)
        effort = 0.3 * np.gradient(v, fine) + np.tanh(v / 0.01) + 0.1 * v
        noisy = q[::250] + 2e-4 * rng.normal(size=20)
        runs.append(AxesRun(str(k), 0.05, {"slide": {"position": noisy, "effort": effort[::250]}}))
    signals = {**columns("position", unit="rad"), **columns("effort", unit="N*m")}
    law = {"motion": "rotary", "mass": 0.3, "command_law": {"kind": "force"}, "encoder_resolution": 1e-4}
    verdict = diagnose(machine(signals=signals, **law), runs).verdict
    force = next(c.parameters["force"] for c in verdict.causes if c.family == "friction" and "force" in c.parameters)
    assert force.low <= 1.0 <= force.high and force.value == pytest.approx(1.0, abs=0.25)
