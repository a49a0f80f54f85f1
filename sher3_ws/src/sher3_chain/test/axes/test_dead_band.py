"""A valve with overlap and a servo that sticks, a sag and a zero: one equation each, so that they are rivals."""

import numpy as np
import pytest
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from slides import servo

PERIOD, BAND, LAG, COUNT = 0.002, 6.7e-3, 48e-3, 1e-5
T = np.arange(0.0, 40.0, PERIOD)
ASKED = 0.12 * np.sin(0.7 * T) + 0.04 * np.sin(2.3 * T + 0.5)


def followed(pace):
    """Position (n,) of a servo at a pace (m/s) that depends on its error, m."""
    q, out = 0.0, np.empty_like(T)
    for k, asked in enumerate(ASKED):
        q += PERIOD * pace(asked - q)
        out[k] = q
    return out


def valve(error):
    """Flow over area of a valve whose edges overlap."""
    return np.sign(error) * max(abs(error) - BAND, 0.0) / LAG


def sticking(error, stiffness=2.0e4):
    """Viscosity times speed is the spring of the servo less its friction."""
    force, holds = stiffness * error, stiffness * BAND
    return (force - np.clip(force, -holds, holds)) / (stiffness * LAG)


@pytest.fixture(scope="module")
def verdict():
    read = COUNT * np.round(followed(valve) / COUNT)
    run = AxesRun("run", PERIOD, {"slide": {"position": read, "reference": ASKED}})
    return diagnose(servo(encoder_resolution=COUNT), [run]).verdict


def test_both_machines_give_the_same_readings():
    assert np.abs(followed(valve) - followed(sticking)).max() < 1e-12


def test_a_dead_band_is_in_the_set_with_what_would_tell_it_apart(verdict):
    """The page is late before it sticks, where this machine is both at once: 9 % too wide."""
    stuck = next(c for c in verdict.causes if c.effect == "coulomb_friction")
    assert "command_deadband" in stuck.rivals
    assert stuck.parameters["force"].value == pytest.approx(BAND, rel=0.1)
    note = next(n for n in verdict.notes if "coulomb friction and command deadband of 0.00" in n)
    assert "recorded force" in note and "two loads tell them apart: friction grows with the load" in note


def test_a_late_servo_has_no_band():
    read = COUNT * np.round(followed(lambda error: error / LAG) / COUNT)
    run = AxesRun("run", PERIOD, {"slide": {"position": read, "reference": ASKED}})
    found = diagnose(servo(encoder_resolution=COUNT), [run]).verdict
    assert {c.effect for c in found.causes} == {"drive_lag"}
    assert not any("same readings" in n for n in found.notes)


@pytest.mark.parametrize("zero", [0.02, -0.05])
def test_a_zero_between_reference_and_place_is_in_the_set_of_a_sag(zero):
    """What is read is off by a constant, or a weight holds the servo there: the same numbers."""
    read = COUNT * np.round((followed(lambda error: error / LAG) + zero) / COUNT)
    run = AxesRun("run", PERIOD, {"slide": {"position": read, "reference": ASKED}})
    found = diagnose(servo(encoder_resolution=COUNT), [run]).verdict
    sag = next(c for c in found.causes if c.effect == "gravity_load")
    assert "encoder_offset" in sag.rivals
    assert sag.parameters["force"].value == pytest.approx(-zero, rel=0.05)
    assert any("a sag grows with the load, a zero does not" in n for n in found.notes)
