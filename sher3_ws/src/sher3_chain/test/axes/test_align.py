"""The moment and the sign of an effort, a load with a mass of its own, weight at an arm, and units of one's own."""

import numpy as np
import pytest
from sher3_chain.joint.own_unit import renamed
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from slides import columns, described, machine

PERIOD = 0.004
T = np.arange(0.0, 20.0, PERIOD)
WAVES = ((0.6, 1.9, 0.0), (0.25, 5.7, 0.4), (0.1, 10.7, 1.0))


def motion(t=T):
    q = sum(s * np.sin(w * t + p) for s, w, p in WAVES)
    v = sum(s * w * np.cos(w * t + p) for s, w, p in WAVES)
    a = -sum(s * w * w * np.sin(w * t + p) for s, w, p in WAVES)
    return q, v, a


def verdict(position, effort, unit="N*m", **more):
    signals = {**columns("position", *more, unit="rad"), **columns("effort", unit=unit)}
    noise = 0.02 * np.random.default_rng(0).normal(size=len(T))
    run = AxesRun("run", PERIOD, {"slide": {"position": position, "effort": effort + noise, **more}})
    law = {"kind": "force"}
    axis = machine(signals=signals, motion="rotary", mass="unknown", command_law=law, encoder_resolution=1e-5)
    return diagnose(axis, [run]).verdict


def force(t=T, mass=0.5, dry=1.0, viscous=0.5):
    _, v, a = motion(t)
    return mass * a + dry * np.tanh(v / 1e-3) + viscous * v


def found(verdict):
    return {(c.effect, n): p for c in verdict.causes for n, p in c.parameters.items()}


@pytest.mark.parametrize("periods", [-0.5, 0.0, 0.5])
def test_an_effort_read_within_its_period_gives_the_same_friction(periods):
    """Half a period of 4 ms is 0.11 N m s/rad of false viscosity at 10.7 rad/s: a tenth of the dry friction."""
    answer = found(verdict(motion()[0], force(T + periods * PERIOD)))
    assert answer["coulomb_friction", "force"].value == pytest.approx(1.0, rel=0.08)
    assert answer["viscous_friction", "extra"].value == pytest.approx(0.5, rel=0.12)


def test_a_load_with_a_second_encoder_has_its_own_acceleration():
    """Half of 1.0 kg m^2 hangs on a spring of 300 N m/rad: the motor's balance is no rigid one."""
    q, v, a = motion()
    load = sum(
        s / (1.0 - w * w * 0.5 / 300.0) * np.array([1.0, 1.0, -w * w])[:, None] * np.array([np.sin(w * T + p)] * 3)
        for s, w, p in WAVES
    )
    answer = verdict(q, 0.5 * a + 0.5 * load[2] + 1.0 * np.tanh(v / 1e-3), load=load[0])
    note = next(n for n in answer.notes if "mass identified" in n)
    assert "0.5 move with the second encoder" in note or "0.501 move" in note or "0.499 move" in note, note
    assert found(answer)["coulomb_friction", "force"].value == pytest.approx(1.0, rel=0.06)
    assert found(answer)["transmission_compliance", "stiffness"].value == pytest.approx(300.0, rel=0.1)


def test_a_weight_that_nobody_described_is_a_weight_and_no_friction():
    q = motion()[0]
    answer = found(verdict(q, force(viscous=0.0) + 3.0 * np.sin(q - 0.2)))
    assert answer["gravity_load", "arm"].value == pytest.approx(3.0, rel=0.02)
    assert answer["gravity_load", "hanging"].value == pytest.approx(0.2, abs=0.02)
    assert answer["coulomb_friction", "force"].value == pytest.approx(1.0, rel=0.06)


def test_a_force_without_a_gain_keeps_its_unit():
    answer = verdict(motion()[0], force(), unit="A")
    assert {p.unit for (_, name), p in found(answer).items() if name in ("force", "extra")} == {"A", "A/(rad/s)"}
    assert any("A/(rad/s^2)" in note for note in answer.notes)
    assert [renamed(u, "%") for u in ("N*m", "N/m", "rad/(N*m)", "kg", "rad")] == [
        "%",
        "%/m",
        "rad/%",
        "%/(m/s^2)",
        "rad",
    ]
    assert described(mass=3.0).axes[0].unit_of_force == "N"


@pytest.mark.parametrize("stiffness", [8.0, 20.0, 60.0])
def test_a_drive_that_pulls_towards_its_reference_has_the_right_sign_though_it_takes_energy(stiffness):
    """An ankle on the ground, which others push, under a PD law."""
    q, v, _ = motion()
    answer = verdict(q, stiffness * (2.0 * q - q) - 3.0 * v, reference=2.0 * q)
    assert not any("opposite sign" in note for note in answer.notes)
