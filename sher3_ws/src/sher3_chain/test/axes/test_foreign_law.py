"""Machines whose law the library does not have: what comes near is doubted. Laws are written here."""

import numpy as np
import pytest
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from slides import columns, effects, machine, servo

PERIOD = 0.005
T = np.arange(0.0, 15.0, PERIOD)


def sway(*waves):
    """Position, speed and acceleration of a sum of sines, (size, rad/s, phase) each."""
    place = sum(s * np.sin(w * T + p) for s, w, p in waves)
    speed = sum(s * w * np.cos(w * T + p) for s, w, p in waves)
    return place, speed, sum(-s * w * w * np.sin(w * T + p) for s, w, p in waves)


def verdict(arm, name, **signals):
    return diagnose(arm, [AxesRun("run", PERIOD, {name: signals})]).verdict


def driven(force, place, mass, **more):
    arm = machine(signals={**columns("position"), **columns("effort", unit="N")}, mass=mass, **more)
    return verdict(arm, "slide", position=place, effort=force)


@pytest.mark.parametrize("seed", [0, 1])
def test_a_magnet_whose_force_goes_with_current_over_gap_squared_is_doubted(seed):
    """Its owner states one newton per ampere, as at one gap: a gain and a payload imitate the law to 98 %."""
    noise = np.random.default_rng(seed)
    place, _, bend = sway((2e-3, 4.4, 0.3), (1e-3, 11.9, 1.0 + seed))
    gap = 0.010 + place
    current = gap * np.sqrt(0.3 * (9.81 - bend) / 2.1e-4) + noise.normal(0.0, 2e-3, len(T))
    seen = gap + noise.normal(0.0, 5e-7, len(T))
    found = driven(-1.4 * current, seen, 0.3, gravity={"constant": -2.943}, encoder_resolution=5e-7)
    (place,) = found.places
    assert next(a.probability for a in place.answers if a.answer == "outside_library") > 0.5


def test_friction_whose_shape_is_another_one_stays_its_cause():
    """Friction that falls with the square root of the speed depends on direction and speed: own inputs."""
    noise = np.random.default_rng(2)
    place, speed, bend = sway((0.05, 1.6, 0.0), (0.02, 4.4, 0.3))
    rub = np.tanh(speed / 5e-4) * (8.0 - 6.0 * np.sqrt(np.abs(speed)))
    found = driven(12.0 * bend + rub + noise.normal(0.0, 0.05, len(T)), place, 12.0)
    assert found.causes and {c.family for c in found.causes} == {"friction"}


def test_a_finger_with_play_has_play_alone():
    """A second cause whose size is none is left out."""
    noise = np.random.default_rng(3)
    motor = 0.4 + sway((0.2, 0.7, 0.0), (0.1, 1.95, 1.0), (0.04, 4.4, 2.0))[0]
    finger, at = np.empty_like(motor), motor[0]
    for k, x in enumerate(motor):
        finger[k] = at = min(max(at, x - 0.012), x + 0.012)
    read = {"position": motor + noise.normal(0.0, 1.4e-4, len(T)), "load": finger + noise.normal(0.0, 1.7e-4, len(T))}
    signals = columns("position", "load", "reference", unit="rad")
    found = verdict(servo(signals=signals, encoder_resolution=1e-4), "slide", reference=motor, **read)
    (cause,) = found.causes
    assert cause.effect == "backlash" and cause.parameters["width"].value == pytest.approx(0.024, rel=0.03)


def test_the_way_of_a_wheel_is_no_second_encoder_of_a_place():
    place = 0.05 * T + 0.002 * np.sin(T)
    signals = columns("position", "load")
    arm = machine(signals=signals, mass=None, command_law={"kind": "none"}, range=[-100.0, 100.0])
    with pytest.raises(ValueError, match=r"load does not follow the axis \(correlation -?0\.\d+\): another quantity"):
        verdict(arm, "slide", position=place, load=np.sin(2.0 * T))


def test_friction_beside_a_spring_makes_a_loop_over_the_force():
    """A harmonic drive on a rig: slipping elements beside a spring of 12 kN m/rad, and a torque sensor."""
    noise = np.random.default_rng(4)
    twist = sway((9e-4, 0.63, 0.0), (5e-4, 1.45, 1.0), (2e-4, 3.8, 2.0))[0]
    stiff, slip = np.array([9e3, 6e3, 3e3]), np.array([1.0, 1.5, 2.0])
    torque, held = np.empty_like(twist), np.zeros(3)
    for k, step in enumerate(np.diff(twist, prepend=twist[0])):
        held = np.clip(held + stiff * step, -slip, slip)
        torque[k] = 12e3 * twist[k] + held.sum()
    out = sway((0.3, 0.44, 0.0), (0.1, 1.2, 0.5))[0]
    signals = {**columns("position", "load", unit="rad"), **columns("effort", unit="N*m")}
    arm = servo(signals=signals, encoder_resolution=4e-7, command_law={"kind": "force"})
    read = {"position": out + twist + noise.normal(0.0, 3.5e-7, len(T)), "effort": torque}
    found = verdict(arm, "slide", load=out + noise.normal(0.0, 1e-6, len(T)), **read)
    assert sorted(effects(found)) == ["transmission_compliance", "transmission_hysteresis"]
    stiffness = next(c for c in found.causes if "stiffness" in c.parameters).parameters["stiffness"].value
    assert 11e3 < stiffness < 14e3
