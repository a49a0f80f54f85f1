"""Readings of an axis that are late, turned or in another scale: named, and the friction beside them stays."""

import numpy as np
import pytest
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from slides import MASS, PERIOD, columns, machine

T = np.arange(0.0, 16.0, PERIOD)
WAVES = ((0.05, 1.6, 0.0), (0.02, 4.4, 0.3))
BOTH = {**columns("position", "load"), **columns("effort", unit="N")}


def place(t):
    return sum(s * np.sin(w * t + p) for s, w, p in WAVES)


def verdict(load=None, effort=1.0):
    """A slide of 12 kg with 5 N of friction and two encoders; `effort` times the force is recorded."""
    speed = sum(s * w * np.cos(w * T + p) for s, w, p in WAVES)
    force = MASS * sum(-s * w * w * np.sin(w * T + p) for s, w, p in WAVES) + 5.0 * np.tanh(speed / 1e-4)
    force = force + 0.05 * np.random.default_rng(0).normal(size=len(T))
    link = place(T) if load is None else load
    read = {"position": place(T), "load": link, "effort": effort * force}
    read = {k: 1e-6 * np.round(x / 1e-6) for k, x in read.items()}
    arm = machine(signals=BOTH, mass=MASS, command_law={"kind": "force"})
    return diagnose(arm, [AxesRun("run", PERIOD, {"slide": read})]).verdict


def friction(found):
    return next(c for c in found.causes if c.effect == "coulomb_friction").parameters["force"].value


def test_three_milliseconds_between_encoders_are_no_play_and_leave_the_friction():
    found = verdict(place(T - 3e-3))
    late = next(c for c in found.causes if c.effect == "sensor_delay")
    assert late.parameters["load_delay"].value == pytest.approx(3e-3, rel=0.02)
    assert friction(found) == pytest.approx(5.0, rel=0.05)
    assert not {"backlash", "transmission_hysteresis"} & {e for c in found.causes for e in (c.effect, *c.rivals)}


def test_a_turned_encoder_and_a_turned_effort_are_said():
    turned = verdict(-place(T))
    assert any("slide.load moves -1 times as far" in n for n in turned.notes)
    assert friction(turned) == pytest.approx(5.0, rel=0.05)
    other = verdict(effort=-1.0)
    assert any("opposite sign" in n for n in other.notes) and friction(other) == pytest.approx(5.0, rel=0.05)


def test_a_scale_of_two_percent_is_a_lead_error():
    found = {c.effect: c for c in verdict(1.02 * place(T)).causes}
    assert found["lead_error"].parameters["relative"].value == pytest.approx(0.02, rel=0.05)


def test_an_effort_at_one_value_is_named():
    found = verdict(effort=0.0)
    assert not found.causes and any("slide.effort reads 0 in 100%" in n for n in found.notes)
