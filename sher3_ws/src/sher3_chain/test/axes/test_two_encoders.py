"""What lies between two encoders of one axis: play or a spring; under a servo and under known loads."""

from types import SimpleNamespace

import numpy as np
import pytest
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from sher3_effects.compliance.transmission_compliance import ComplianceOnAxis
from slides import columns, machine, servo

PERIOD = 0.002
T = np.arange(0.0, 20.0, PERIOD)
R = 0.4 * np.sin(0.9 * T) + 0.1 * np.sin(2.7 * T)
COUNT = 1e-5


def behind_a_gap(x, width):
    return behind_a_gap_from(x[0], x, width)


def behind_a_gap_from(side, x, width):
    out = np.empty_like(x)
    for k, place in enumerate(x):
        side = min(max(side, place - 0.5 * width), place + 0.5 * width)
        out[k] = side
    return out


def read(x):
    return COUNT * np.round(x / COUNT)


def of_servo(position, load, **more):
    signals = columns("position", "reference", "load", *(("applied",) if "applied" in more else ()), unit="rad")
    if "applied" in more:
        signals["applied"]["unit"] = "N*m"
    run = AxesRun("run", PERIOD, {"slide": {"position": read(position), "reference": R, "load": read(load), **more}})
    return diagnose(servo(signals=signals, encoder_resolution=COUNT), [run]).verdict


def between(verdict):
    return {c.effect: c for c in verdict.causes if c.stage in ("transmission", "sensing")}


def test_the_play_of_a_servo_is_found_in_position_mode_too():
    """2.0 mrad between the encoders of a servo that follows its reference exactly."""
    found = between(of_servo(R, behind_a_gap(R, 2.0e-3)))
    assert set(found) == {"backlash"}
    assert found["backlash"].parameters["width"].value == pytest.approx(2.0e-3, rel=0.03)


def test_the_play_of_a_late_servo_is_its_transmission_s():
    """A servo 40 ms behind its reference, with 1 mrad of play: a lag of the servo and a gap behind it."""
    from scipy.signal import lfilter

    share = 1.0 - np.exp(-PERIOD / 0.04)
    position = lfilter([share], [1.0, share - 1.0], R)
    verdict = of_servo(position, behind_a_gap(position, 1.0e-3))
    assert set(between(verdict)) == {"backlash"}
    assert {"timing", "lost_motion"} == {c.family for c in verdict.causes}


def of_forceps(motor, load):
    signals = columns("position", "load", unit="rad")
    run = AxesRun("run", PERIOD, {"slide": {"position": motor, "load": load}})
    free = machine(signals=signals, command_law={"kind": "none"}, motion="rotary", mass=None, encoder_resolution=COUNT)
    return diagnose(free, [run]).verdict


STROKES = {"one": np.sin(1.57 * T), "two": np.sin(1.57 * T) + 0.4 * np.sin(3.83 * T + 1.0)}


@pytest.mark.parametrize("stroke", STROKES)
@pytest.mark.parametrize("ratio", [0.91, 0.97, 1.06])
@pytest.mark.parametrize("width", [0.76, 0.2])
def test_a_ratio_beside_a_gap_is_told_from_a_wider_gap_and_from_a_loop(stroke, ratio, width):
    """Forceps on a tendon: of 1 rad a gap takes up to 44 degrees, and a pulley makes less, or more, of it."""
    motor, rng = STROKES[stroke], np.random.default_rng(1)
    load = 0.02 + ratio * behind_a_gap_from(0.0, motor, width) + 0.003 * rng.normal(size=len(T))
    found = between(of_forceps(motor, load))
    assert set(found) == {"backlash", "lead_error"}
    assert found["backlash"].parameters["width"].value == pytest.approx(ratio * width, rel=0.1)
    assert found["lead_error"].parameters["relative"].value == pytest.approx(ratio - 1.0, abs=0.016)


def test_a_load_that_begins_between_the_flanks_widens_no_gap():
    """The motor goes 0.4 rad in the first quarter of a second, through half of the gap, from another zero."""
    motor, rng = STROKES["one"], np.random.default_rng(2)
    load = 0.5 + behind_a_gap_from(0.0, motor, 0.76) + 0.003 * rng.normal(size=len(T))
    found = between(of_forceps(motor, load))
    assert set(found) == {"backlash"}
    assert found["backlash"].parameters["width"].value == pytest.approx(0.76, rel=0.005)


def test_a_spring_between_the_encoders_gives_way_to_a_known_load():
    """Weights of up to 5 N m are hung on a held joint whose gear has 500 N m/rad: 10 mrad."""
    applied = 5.0 * np.round(np.sin(0.5 * T))
    found = between(of_servo(R, R + applied / 500.0, applied=applied))
    assert set(found) == {"transmission_compliance"}
    assert found["transmission_compliance"].parameters["stiffness"].value == pytest.approx(500.0, rel=0.06)


def test_a_gap_under_a_known_load_is_crossed_by_the_load():
    """A held joint: its motor rests, the load lies on whichever flank the weight pushes it to, 3 mrad apart."""
    applied = np.where(np.sin(0.5 * T) > 0.0, 1.0, -1.0)
    still = np.zeros_like(R)
    signals = columns("position", "reference", "load", "applied", unit="rad")
    signals["applied"]["unit"] = "N*m"
    rng = np.random.default_rng(0)
    load = read(1.5e-3 * applied + 2e-6 * rng.normal(size=len(T)))
    run = AxesRun("run", PERIOD, {"slide": {"position": still, "reference": still, "load": load, "applied": applied}})
    found = between(diagnose(servo(signals=signals, encoder_resolution=COUNT), [run]).verdict)
    assert {"backlash", "transmission_compliance"} & set(found)
    cause = next(iter(found.values()))
    assert {cause.effect, *cause.rivals} >= {"backlash", "transmission_compliance"}, (
        "two loads tell no spring from a gap"
    )


def test_a_spring_is_found_from_the_recorded_effort():
    """The mass is not stated: the recorded effort tells the force on a spring of 2e5 N/m."""
    effort = 40.0 * np.sin(1.9 * T + 0.4) + 15.0 * np.sin(3.1 * T)
    signals = {**columns("position", "load"), **columns("effort", unit="N")}
    run = AxesRun(
        "run", PERIOD, {"slide": {"position": read(0.1 * R), "load": 0.1 * R - effort / 2e5, "effort": effort}}
    )
    arm = machine(signals=signals, mass=None, command_law={"kind": "force"}, encoder_resolution=1e-6)
    found = between(diagnose(arm, [run]).verdict)
    assert set(found) == {"transmission_compliance"}
    assert found["transmission_compliance"].parameters["stiffness"].value == pytest.approx(2e5, rel=0.06)


def test_a_log_shows_no_resonance_beyond_half_its_rate():
    views = [SimpleNamespace(run=SimpleNamespace(period=period)) for period in (0.002, 0.022)]
    assert max(ComplianceOnAxis().shown(views[:1])) == 50.0 and max(ComplianceOnAxis().shown(views)) == 20.0
