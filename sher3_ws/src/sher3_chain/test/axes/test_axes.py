"""Simulated axes: what the engine says of them."""

from dataclasses import replace

import numpy as np
import pytest
from sher3_chain.axes.foreseen import WEIGHED
from sher3_chain.axes.machine import Axes, facts_of
from sher3_chain.chain.machine import NO_REPEATS
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from sher3_diagnosis.flow import UnknownEffect
from sher3_machines import MachineError
from slides import COUNT, MASS, PERIOD, axis_of, columns, described, driven, effects, machine, run_of, servo, verdict_of

NO_LAW = {"kind": "force", "held": True}
"""A command that follows no stated law: a test adds to it."""


@pytest.fixture(scope="module")
def rubbed():
    return driven(coulomb=5.0, viscous=40.0)


def test_a_healthy_axis_has_no_gap():
    assert verdict_of(driven()).status == "no_gap"


def test_friction_is_found_and_its_force(rubbed):
    verdict = verdict_of(rubbed)
    causes = {c.effect: c for c in verdict.causes}
    assert verdict.status == "attributed"
    assert set(causes) == {"coulomb_friction", "viscous_friction"}
    assert causes["coulomb_friction"].parameters["force"].value == pytest.approx(5.0, rel=0.06)
    assert causes["viscous_friction"].parameters["extra"].value == pytest.approx(40.0, rel=0.1)
    assert verdict.closure.tip.value > 0.95


def test_an_unknown_mass_is_identified_beside_friction(rubbed):
    verdict = verdict_of(rubbed, mass="unknown")
    note = next(n for n in verdict.notes if "mass identified" in n)
    assert float(note.split(" as ")[1].split()[0]) == pytest.approx(MASS, rel=0.02)
    assert "coulomb_friction" in effects(verdict)


def test_left_out_friction_is_not_answered_with_another_family(rubbed):
    frictions = {"coulomb_friction", "stribeck_friction", "presliding_friction", "viscous_friction"}
    assert verdict_of(rubbed, without=frictions).status in ("outside_library", "under_excited")


def test_an_effect_the_machine_cannot_have_cannot_be_left_out(rubbed):
    with pytest.raises(UnknownEffect, match="base_tilt"):
        verdict_of(rubbed, without=["base_tilt"])


def test_a_pinned_command_is_a_limit():
    rows = driven(seconds=8.0, limit=0.9, offset=0.3)
    limits = [c for c in verdict_of(rows).causes if c.effect == "force_saturation"]
    assert limits and limits[0].parameters["limit"].value == pytest.approx(0.9, rel=0.02)
    assert "force_saturation" not in effects(verdict_of(rows, without=["force_saturation"]))


def test_backlash_needs_the_second_encoder(rubbed):
    q = rubbed[:, 0]
    load, side = np.empty_like(q), q[0]
    for k, x in enumerate(q):
        side = min(max(side, x - 2e-5), x + 2e-5)
        load[k] = COUNT * round(side / COUNT)
    signals = {**columns("position", "reference", "load"), **columns("command", unit="N")}
    verdict = diagnose(machine(signals=signals), [run_of(rubbed, load=load)]).verdict
    backlash = [c for c in verdict.causes if c.effect == "backlash"]
    assert backlash and backlash[0].parameters["width"].value == pytest.approx(4e-5, rel=0.1)
    assert not [c for c in verdict_of(rubbed).causes if c.family == "lost_motion"]


@pytest.mark.parametrize(("lag", "sag", "stick"), [(0.08, 0.0, 0.0), (0.0, 0.03, 0.0), (0.05, 0.02, 0.01)])
def test_lag_sag_and_stiction_of_a_servo(lag, sag, stick):
    t = np.arange(0.0, 60.0, 0.02)
    r = 0.4 * np.sin(0.9 * t) + 0.1 * np.sin(2.7 * t)
    q, out = r[0] - sag, np.empty_like(r)
    for k, x in enumerate(r):
        out[k] = q
        error = x - q - sag
        push = error - np.clip(error, -stick, stick)
        q += push * (1.0 - np.exp(-0.02 / lag)) if lag else push
    count = 1.5e-3
    run = AxesRun("run", 0.02, {"slide": {"position": count * np.round(out / count), "reference": r}})
    verdict = diagnose(servo(encoder_resolution=count), [run]).verdict
    found = {c.effect: c for c in verdict.causes}
    expected = {n for n, x in (("drive_lag", lag), ("gravity_load", sag), ("coulomb_friction", stick)) if x}
    late = {"command_delay": "drive_lag"}
    assert {late.get(e, e) for e in found} >= expected
    assert {w.unit for w in verdict.where} == {"rad"} and {w.stage for w in verdict.where} == {"motor_mechanics"}
    if sag:
        assert found["gravity_load"].parameters["force"].value == pytest.approx(sag, rel=0.1)
        assert found["gravity_load"].parameters["force"].unit == "rad"


def test_an_ideal_servo_has_no_gap():
    t = np.arange(0.0, 20.0, 0.02)
    r, count = 0.5 * np.sin(t), 1e-3
    noise = 2e-4 * np.random.default_rng(0).normal(size=len(t))
    run = AxesRun("run", 0.02, {"slide": {"position": count * np.round((r + noise) / count), "reference": r}})
    assert diagnose(servo(), [run]).verdict.status == "no_gap"


def test_wrong_mass_and_force_scale_stay_rivals():
    """Without weight or friction both scale with the acceleration alone: the answer is a question."""
    verdict = verdict_of(driven(seconds=12.0), mass=0.8 * MASS)
    named = {verdict.causes[0].effect, *verdict.causes[0].rivals}
    assert verdict.status == "under_excited"
    assert named == {"payload_mass", "torque_constant"}
    asked = verdict.next_experiment
    assert set(asked.separates) == named
    assert asked.added == WEIGHED
    assert asked.expected_odds > 0.9


def test_a_record_with_a_known_mass_and_the_first_are_judged_as_one():
    first, second = (run_of(driven(seconds=12.0, mass=m)) for m in (MASS, 2.0 * MASS))
    runs = [first, replace(second, name="weighed")]
    verdict = diagnose(machine(mass=0.8 * MASS, carried={"weighed": MASS}), runs).verdict
    assert verdict.status == "attributed"
    (cause,) = verdict.causes
    assert cause.effect == "payload_mass" and not cause.rivals
    assert cause.parameters["mass"].value == pytest.approx(0.2 * MASS, rel=0.02)


def test_what_was_carried_names_a_run_and_stands_beside_a_stated_mass():
    with pytest.raises(MachineError, match="names no run"):
        diagnose(machine(carried={"other": 1.0}), [run_of(driven(seconds=2.0))])
    with pytest.raises(ValueError, match="beside a stated `mass`"):
        machine(mass="unknown", carried={"run": 1.0})


def test_a_force_no_effect_makes_is_not_explained():
    rows = driven(seconds=12.0)
    rows[:, 2] += np.sin(2.0 * np.pi * 7.0 * np.arange(len(rows)) * PERIOD)
    verdict = verdict_of(rows, command_law=NO_LAW)
    assert verdict.status == "outside_library" and "near 7.0 Hz" in verdict.unexplained.signature


def test_two_axes_are_judged_each_by_itself(rubbed):
    """The second axis is the healthy slide: only the first one is named."""
    healthy = driven()
    n = min(len(rubbed), len(healthy))
    axis = axis_of()
    pair = described().model_copy(update={"axes": (axis, axis.model_copy(update={"name": "other"}))})
    names = ("position", "reference", "command")
    signals = {
        "slide": dict(zip(names, rubbed[:n].T, strict=True)),
        "other": dict(zip(names, healthy[:n].T, strict=True)),
    }
    verdict = diagnose(Axes(pair), [AxesRun("run", PERIOD, signals)]).verdict
    assert {c.actuator for c in verdict.causes} == {w.actuator for w in verdict.where} == {"slide"}


def test_notes_say_what_cannot_be_told():
    assert machine().audit([run_of(driven(1.0))]) == [NO_REPEATS]
    repeated = Axes(described().model_copy(update={"repeats": True}))
    signals = run_of(driven(1.0)).signals
    runs = [AxesRun(name, PERIOD, signals, [f"{name}: resampled"]) for name in "ab"]
    assert repeated.audit(runs) == ["a, b: resampled"]


def test_an_effort_without_a_mass_is_refused_with_the_word_that_is_missing():
    with pytest.raises(MachineError, match="`mass` is not stated: state it, or `mass: unknown`"):
        signals = {**columns("position"), **columns("effort", unit="N")}
        found = run_of(driven(1.0)).signals["slide"]
        kept = {"position": found["position"], "effort": found["command"]}
        diagnose(machine(mass=None, signals=signals), [AxesRun("run", PERIOD, {"slide": kept})])


def test_facts_are_what_the_description_states():
    assert facts_of(axis_of()) == {"mass", "drive", "forces", "no_lead", "alone"}
    assert facts_of(axis_of(lead=0.005, mass="unknown", command_law={"kind": "none"})) == {"lead", "alone"}
    assert facts_of(axis_of(encoder_at="load")) == {"mass", "drive", "forces", "no_lead", "behind"}


def test_the_force_of_the_user_s_own_model_takes_the_place_of_mass_and_weight(rubbed):
    """Weight and coupling that no description of an axis could state, given as a column: friction is what is left."""
    q, _, u = rubbed.T
    coupling = 30.0 * np.sin(40.0 * q) + 12.0
    own = MASS * np.gradient(np.gradient(q, PERIOD), PERIOD) + coupling
    signals = {**columns("position"), **columns("effort", "nominal_effort", unit="N")}
    run = AxesRun("run", PERIOD, {"slide": {"position": q, "effort": u + coupling, "nominal_effort": own}})
    law = {"kind": "force"}
    verdict = diagnose(machine(signals=signals, mass=None, command_law=law), [run]).verdict
    assert set(effects(verdict)) == {"coulomb_friction", "viscous_friction"}


def test_a_known_disturbance_is_no_cause(rubbed):
    """7 N pushed along for the second half: declared, it is neither a constant force nor a change of friction."""
    q, r, u = rubbed.T
    applied = np.where(np.arange(len(q)) > len(q) // 2, 7.0, 0.0)
    signals = {**columns("position", "reference"), **columns("command", "applied", unit="N")}
    run = AxesRun("run", PERIOD, {"slide": {"position": q, "reference": r, "command": u - applied, "applied": applied}})
    verdict = diagnose(machine(signals=signals, command_law=NO_LAW), [run]).verdict
    assert set(effects(verdict)) == {"coulomb_friction", "viscous_friction"}
