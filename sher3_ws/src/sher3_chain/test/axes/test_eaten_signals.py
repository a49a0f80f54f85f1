"""Signals that a second difference cannot foresee: a resonance near the rate, a servo whose reference switches."""

import numpy as np
import pytest
from sher3_chain.axes.machine import Axes
from sher3_chain.joint.description import AxesDescription
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from slides import columns

RATE, RESONANCE = 610.35, 68.0
"""Of the record, and of an oscillator of unit stiffness, Hz."""


def verdict_of(axis, period, **signals):
    fields = {"kind": "axes", "name": "one", "time": {"column": "t", "unit": "s"}, "axes": [{"name": "x", **axis}]}
    run = AxesRun("run", period, {"x": signals})
    return diagnose(Axes(AxesDescription.model_validate(fields)), [run]).verdict


def oscillator(seed, noise):
    """An oscillator of which the description knows the mass alone, driven by noise up to 200 Hz."""
    rng, period, n = np.random.default_rng(seed), 1.0 / RATE, 9000
    pace, fine = 2 * np.pi * RESONANCE, 20
    power = np.fft.rfft(rng.normal(size=n)) * (np.fft.rfftfreq(n, period) < 200.0)
    force = np.fft.irfft(power, n)
    force *= 0.1 / force.std()
    place, x, v, h = np.empty(n), 0.0, 0.0, period / fine
    for k, pushed in enumerate(force.tolist()):
        place[k] = x
        for _ in range(fine):
            v += h * (pace**2 * (pushed - x) - 0.1 * pace * v)
            x += h * v
    signals = {**columns("position"), **columns("effort", unit="N")}
    axis = {"motion": "linear", "signals": signals, "command_law": {"kind": "force", "held": True}, "mass": pace**-2}
    read = 1e-4 * np.round(place / 1e-4)
    given = force + noise * rng.normal(size=n)
    return verdict_of({**axis, "encoder_resolution": 1e-4}, period, position=read, effort=given)


def servo(lag, top, seed):
    """A servo with a lag and a top speed whose reference switches every 80 ms; 50 Hz."""
    rng, period, fine = np.random.default_rng(seed), 0.02, 20
    asked = np.repeat(rng.uniform(-0.6, 0.6, size=500), 4)
    place, x = np.empty(len(asked)), 0.0
    for k, goal in enumerate(asked.tolist()):
        place[k] = x
        for _ in range(fine):
            x += period / fine * min(max((goal - x) / lag, -top), top)
    signals = columns("position", "reference", unit="rad")
    axis = {"motion": "rotary", "signals": signals, "command_law": {"kind": "position"}, "encoder_resolution": 1e-3}
    return verdict_of(axis, period, position=1e-3 * np.round(place / 1e-3), reference=asked)


@pytest.mark.parametrize("seed", [0, 1])
def test_a_spring_near_the_rate_of_the_record_is_no_floor(seed):
    verdict = oscillator(seed, noise=1e-3)
    found = {c.effect: c for c in verdict.causes}
    assert verdict.status == "attributed" and set(found) == {"spring_torque", "viscous_friction"}
    assert found["spring_torque"].parameters["stiffness"].value == pytest.approx(1.0, rel=0.02)


@pytest.mark.parametrize(("lag", "top"), [(0.12, 2.5), (0.05, 1.5)])
def test_lag_and_top_speed_of_a_servo_whose_reference_switches(lag, top):
    (cause,) = servo(lag, top, seed=3).causes
    assert cause.effect == "speed_limit"
    assert cause.parameters["limit"].value == pytest.approx(top, rel=0.01)
    assert cause.parameters["time_constant"].value == pytest.approx(lag, rel=0.03)


def test_no_gap_is_no_finding_where_noise_hides_most():
    verdict = oscillator(1, noise=0.2)
    assert verdict.status == "outside_library" and not verdict.causes
    assert "cannot be judged" in verdict.unexplained.signature
    assert "repeats of one motion would tell" in verdict.unexplained.signature
    assert {a.answer for a in verdict.places[0].answers} == {"outside_library", "no_gap"}


def test_a_stiction_that_is_never_broken_loose_is_none():
    """Held throughout, the error of a servo would be its reference: any record could be told so."""
    verdict = servo(0.12, 99.0, seed=0)
    assert [c.effect for c in verdict.causes] == ["drive_lag"]
