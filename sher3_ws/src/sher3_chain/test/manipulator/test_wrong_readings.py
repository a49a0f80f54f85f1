"""Readings of an arm that are late, scaled, dead or flat: each is named, and none becomes a fault of the machine."""

import numpy as np
import pytest
from lifts import PERIOD, friction, machine, needed
from sher3_chain.joint.record import AxesRun
from sher3_chain.manipulator.evidence import not_judged
from sher3_diagnosis import diagnose

JOINTS = ("lift", "swing")
BOTH = {j: {"signals": {s: {"column": s, "unit": "1"} for s in ("position", "effort", "load")}} for j in JOINTS}
T = np.arange(0.0, 30.0, PERIOD)
WAVES = [[(0.2, 1.1, 0.0), (0.1, 2.3, 0.4)], [(0.8, 0.9, 0.3), (0.5, 2.1, 1.0)]]


def motion(t):
    """Position, velocity and acceleration at some times, (n, 2) each."""
    q = np.stack([sum(a * np.sin(w * t + p) for a, w, p in joint) for joint in WAVES], axis=1)
    v = np.stack([sum(a * w * np.cos(w * t + p) for a, w, p in joint) for joint in WAVES], axis=1)
    return q, v, np.stack([sum(-a * w * w * np.sin(w * t + p) for a, w, p in joint) for joint in WAVES], axis=1)


def verdict(path, load=None, effort=None, noise=0.0, coulomb=(0.0, 0.0)):
    """Diagnose the lift with second encoders; `load` (n,) and `effort` (n,) take the place of the swing's readings."""
    rng = np.random.default_rng(0)
    q, v, a = motion(T)
    given = needed(q, v, a) + friction(v, coulomb) + 0.02 * rng.normal(size=q.shape)
    if effort is not None:
        given[:, 1] = effort(given[:, 1])
    link = q.copy()
    link[:, 1] = q[:, 1] if load is None else load
    read = [1e-6 * np.round((x + noise * rng.normal(size=x.shape)) / 1e-6) for x in (q, link)]
    signals = {
        j: {"position": read[0][:, i], "effort": given[:, i], "load": read[1][:, i]} for i, j in enumerate(JOINTS)
    }
    return diagnose(machine(path, joint=BOTH), [AxesRun("run", PERIOD, signals)]).verdict


@pytest.fixture
def path(tmp_path):
    return tmp_path / "lift.urdf"


SWING = motion(T)[0][:, 1]


def late(delay):
    return motion(T - delay)[0][:, 1]


def play(q, width=3e-3):
    side, out = q[0], np.empty_like(q)
    for k, x in enumerate(q):
        side = min(max(side, x - width / 2), x + width / 2)
        out[k] = side
    return out


@pytest.mark.parametrize(("delay", "noise"), [(3e-3, 0.0), (3e-3, 20e-6), (3e-3, 100e-6), (-3e-3, 0.0), (12e-3, 0.0)])
def test_a_late_second_encoder_is_late_and_nothing_else(path, delay, noise):
    """3 ms are no backlash, and do not move the links: no friction or spring is made of what they would need."""
    found = verdict(path, late(delay), noise=noise)
    assert found.status == "attributed"
    (cause,) = found.causes
    assert (cause.effect, cause.actuator) == ("sensor_delay", "swing")
    assert cause.parameters["load_delay"].value == pytest.approx(delay, rel=0.03)
    assert not {"backlash", "transmission_hysteresis", "transmission_compliance"} & set(cause.rivals)


def test_a_late_encoder_leaves_the_friction_of_its_joint(path):
    found = {c.effect: c for c in verdict(path, late(3e-3), coulomb=(0.0, 0.5)).causes if c.actuator == "swing"}
    assert set(found) == {"sensor_delay", "coulomb_friction"}
    assert found["coulomb_friction"].parameters["force"].value == pytest.approx(0.5, rel=0.06)


def test_play_is_play_and_behind_a_late_encoder_both(path):
    assert [c.effect for c in verdict(path, play(SWING)).causes] == ["backlash"]
    both = {c.effect: c for c in verdict(path, play(late(3e-3))).causes}
    assert set(both) == {"backlash", "sensor_delay"}
    assert both["backlash"].parameters["width"].value == pytest.approx(3e-3, rel=0.05)
    assert both["sensor_delay"].parameters["load_delay"].value == pytest.approx(3e-3, rel=0.05)


@pytest.mark.parametrize("delay", [3e-3, 10e-3, -10e-3])
def test_a_late_effort_is_late(path, delay):
    found = verdict(path, effort=lambda e: np.interp(T - delay, T, e))
    (cause,) = found.causes
    assert found.status == "attributed" and (cause.effect, cause.actuator) == ("sensor_delay", "swing")
    assert cause.parameters["effort_delay"].value == pytest.approx(delay, abs=0.3e-3)


WRONG = {
    "not connected": (0.0 * SWING, "swing.load reads 0 in 100%"),
    "noise alone": (1e-5 * np.random.default_rng(1).normal(size=len(T)), "swing.load moves by"),
    "half": (0.5 * SWING, "swing.load moves 0.5 times as far"),
    "backwards": (-SWING, "swing.load moves -1 times as far"),
    "degrees": (np.degrees(SWING), "swing.load moves 57.3 times as far"),
    "flat": (np.minimum(SWING, 0.2), "swing.load stays at one reading while the axis moves over"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_second_encoder_is_named_and_moves_no_link(path, name):
    load, words = WRONG[name]
    found = verdict(path, load)
    assert found.status == "no_gap" and any(words in n and "left out" in n for n in found.notes)


def test_another_scale_of_two_percent_is_one_cause(path):
    """The force balance says which of the two encoders the link follows."""
    (cause,) = verdict(path, 1.02 * SWING).causes
    assert cause.effect == "lead_error" and cause.parameters["relative"].value == pytest.approx(0.02, rel=0.05)


def test_an_effort_in_another_unit_is_named_and_its_joint_not_judged(path):
    found = verdict(path, effort=lambda e: 1000.0 * e, coulomb=(8.0, 0.0))
    assert {(c.effect, c.actuator) for c in found.causes} == {("coulomb_friction", "lift")}
    assert any("swing: effort is 1000 times what the model needs" in n for n in found.notes)
    assert any(n.startswith("not judged") and "swing" in n for n in found.notes)


def test_an_effort_at_its_limit_is_said_and_its_flat_part_not_judged(path):
    found = verdict(path, effort=lambda e: np.minimum(e, 2.0), coulomb=(0.0, 0.5))
    assert {(c.effect, c.actuator) for c in found.causes} == {("coulomb_friction", "swing")}
    assert any("swing.effort lies flat at its largest reading" in n for n in found.notes)


def test_a_drive_that_is_ten_milliseconds_early_on_a_light_joint_is_not_lost_in_its_floor(path):
    """2 % of the torque under as much noise: too little for its power, plain by its shape."""
    noise = 0.1 * np.random.default_rng(2).normal(size=len(T))
    found = verdict(path, effort=lambda e: np.interp(T + 10e-3, T, e) + noise)
    (cause,) = found.causes
    assert (cause.effect, cause.actuator) == ("sensor_delay", "swing")
    assert cause.parameters["effort_delay"].low <= -10e-3 <= cause.parameters["effort_delay"].high
    assert verdict(path, effort=lambda e: e + noise).status == "no_gap"


def test_joints_without_forces_and_references_are_not_told_to_be_servos():
    assert "record efforts, or references" in str(not_judged([], [], {}))
