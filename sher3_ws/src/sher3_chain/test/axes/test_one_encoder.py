"""Play and springs that one encoder sees: by the effort of the motor, or before the encoder of a servo."""

import numpy as np
import pytest
from scipy.signal import lfilter
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from slides import effects, servo
from two_masses import behind_gap, on_spring, slowly_stuck, verdict_of

T = np.arange(0.0, 20.0, 0.002)
R = 0.4 * np.sin(0.9 * T) + 0.1 * np.sin(2.7 * T)
ANGLE = 1e-5
"""Count of the servo's encoder, rad."""


def of(verdict, effect):
    return next(c.parameters for c in verdict.causes if c.effect == effect)


def said(verdict):
    return next(n for n in verdict.notes if "one encoder" in n)


@pytest.mark.parametrize("gap", [1e-4, 3e-4, 1e-3])
def test_the_effort_shows_a_gap_behind_the_motor(gap):
    """6 kg of 12 kg, 6 N of 10 N behind the gap."""
    verdict = verdict_of(behind_gap(gap))
    assert set(effects(verdict)) == {"coulomb_friction", "viscous_friction", "backlash"}
    found = of(verdict, "backlash")
    assert found["width"].value == pytest.approx(gap, rel=0.12)
    assert found["load_mass"].value == pytest.approx(6.0, rel=0.35)
    assert found["load_friction"].value == pytest.approx(6.0, rel=0.25)


def test_a_load_that_flies_across_the_gap():
    """Its friction of 0.5 N brakes it by less than the motor brakes."""
    found = of(verdict_of(behind_gap(3e-4, load=(6.0, 0.5))), "backlash")
    assert found["width"].value == pytest.approx(3e-4, rel=0.12)
    assert found["load_mass"].value == pytest.approx(6.0, rel=0.15)


def test_an_unknown_mass_and_a_noisy_encoder():
    verdict = verdict_of(behind_gap(3e-4, noise=2e-6), mass="unknown")
    assert of(verdict, "backlash")["width"].value == pytest.approx(3e-4, rel=0.12)


def test_below_its_limit_no_play_is_named():
    """The notes say which play would show: a fifth of that is not named, twice as much is."""
    verdict = verdict_of(behind_gap(0.0))
    size, unit = said(verdict).split("play above ")[1].split()[:2]
    limit = 1e-6 * float(size)
    assert unit == "µm"
    assert 1e-5 < limit < 1e-4
    assert "backlash" not in effects(verdict_of(behind_gap(0.2 * limit)))
    assert "backlash" in effects(verdict_of(behind_gap(2.0 * limit)))


@pytest.mark.parametrize("frequency", [5.0, 10.0, 20.0])
def test_the_effort_shows_a_spring_behind_the_motor(frequency):
    """4 kg of 12 kg hang on it."""
    verdict = verdict_of(on_spring(frequency))
    found = of(verdict, "transmission_compliance")
    assert found["frequency"].value == pytest.approx(frequency, rel=0.03)
    assert found["stiffness"].value == pytest.approx(4.0 * (2.0 * np.pi * frequency) ** 2, rel=0.15)
    assert "backlash" not in effects(verdict)


@pytest.mark.parametrize("reach", [1e-5, 1e-4])
def test_a_friction_that_builds_up_slowly_is_no_gap(reach):
    assert not {"backlash", "transmission_compliance"} & set(effects(verdict_of(slowly_stuck(reach))))


def of_servo(width, at):
    share = 1.0 - np.exp(-0.002 / 0.02)
    motor, side, load = lfilter([share], [1.0, share - 1.0], R), 0.0, []
    for place in motor:
        side = min(max(side, place - 0.5 * width), place + 0.5 * width)
        load.append(side)
    signals = {"position": ANGLE * np.round(np.array(load) / ANGLE), "reference": R}
    return diagnose(servo(encoder_resolution=ANGLE, encoder_at=at), [AxesRun("run", 0.002, {"slide": signals})]).verdict


def test_before_the_encoder_of_a_servo_play_and_sticking_are_rivals():
    verdict = of_servo(2e-3, "load")
    assert verdict.status == "under_excited"
    stuck = next(c for c in verdict.causes if c.effect in ("coulomb_friction", "backlash"))
    assert {stuck.effect, *stuck.rivals} >= {"coulomb_friction", "backlash"}


def test_a_servo_says_what_its_encoder_does_not_see():
    assert "not in the data" in said(of_servo(0.0, "motor"))
    assert "play before it above" in said(of_servo(0.0, "load"))
