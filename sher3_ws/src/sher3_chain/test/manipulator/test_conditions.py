"""The lift under several conditions: what changed is named, what is common is held common."""

import re

import numpy as np
import pytest
from lifts import URDF, L, friction, machine, motion, needed, run_of
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from sher3_machines import MachineError

FRICTION = {"coulomb": (8.0, 0.5), "viscous": (20.0, 0.4)}


def recorded(name, seed, extra=0.0, **changed):
    q, v, a = motion(12.0, seed=seed)
    return run_of(q, needed(q, v, a, extra, 0.05, -L) + friction(v, **{**FRICTION, **changed}), name=name)


def changes(verdict):
    return {(c.effect, c.actuator): c for c in verdict.causes if c.condition}


def test_a_payload_between_two_runs_is_named_with_mass_and_centre(tmp_path):
    arm = machine(tmp_path / "lift.urdf", conditions={"a": {"payload": "none"}, "b": {"payload": "cup"}})
    verdict = diagnose(arm, [recorded("a", 0.0), recorded("b", 0.7, extra=0.5)]).verdict
    found = changes(verdict)
    assert set(found) == {("payload_mass", "pendulum")}
    cause = found["payload_mass", "pendulum"]
    assert cause.condition == "payload cup"
    assert cause.parameters["mass"].value == pytest.approx(0.5, rel=0.05)
    assert cause.parameters["x"].value == pytest.approx(0.05, abs=0.01)
    assert cause.parameters["z"].value == pytest.approx(-L, abs=0.03)
    common = {(c.effect, c.actuator): c.parameters for c in verdict.causes if not c.condition}
    assert common["coulomb_friction", "lift"]["force"].value == pytest.approx(8.0, rel=0.06)
    assert any("payload cup against none, all else held common: payload mass" in n for n in verdict.notes)


def test_a_payload_is_told_beside_inertias_that_the_reference_has(tmp_path):
    """The model's links weigh half of the real ones; what hangs on them in the other run is no inertia of theirs."""
    rough = URDF.replace('mass value="2.0"', 'mass value="1.0"').replace('mass value="4.0"', 'mass value="2.0"')
    conditions = {"a": {"payload": "none"}, "b": {"payload": "cup"}}
    arm = machine(tmp_path / "lift.urdf", text=rough, inertias="identified", conditions=conditions)
    verdict = diagnose(arm, [recorded("a", 0.0), recorded("b", 0.7, extra=0.5)]).verdict
    found = changes(verdict)
    assert set(found) == {("payload_mass", "pendulum")}
    assert found["payload_mass", "pendulum"].parameters["mass"].value == pytest.approx(0.5, rel=0.1)
    assert any("identified from the runs of the reference" in note for note in verdict.notes)
    assert not {c.effect for c in verdict.causes} & {"gravity_load", "torque_constant"}


def test_a_repaired_joint_has_less_friction_than_before(tmp_path):
    """The gear of the swing is repaired: 0.3 of its 0.5 N m of friction are gone, below nothing is refused."""
    arm = machine(tmp_path / "lift.urdf", conditions={"a": {"day": "Monday"}, "b": {"day": "Friday"}})
    verdict = diagnose(arm, [recorded("a", 0.0), recorded("b", 0.7, coulomb=(8.0, 0.2))]).verdict
    found = changes(verdict)
    assert set(found) == {("coulomb_friction", "swing")}
    assert found["coulomb_friction", "swing"].parameters["force"].value == pytest.approx(-0.3, rel=0.1)


def test_drift_between_temperatures_is_the_change_alone(tmp_path):
    """The grease of the lift is warmer: 20 N/(m/s) become 12; its dry friction stays."""
    arm = machine(tmp_path / "lift.urdf", conditions={"a": {"temperature": "20"}, "b": {"temperature": "35"}})
    verdict = diagnose(arm, [recorded("a", 0.0), recorded("b", 0.7, viscous=(12.0, 0.4))]).verdict
    found = changes(verdict)
    assert set(found) == {("viscous_friction", "lift")} and found["viscous_friction", "lift"].condition
    assert found["viscous_friction", "lift"].parameters["extra"].value == pytest.approx(-8.0, rel=0.1)


def test_the_reply_of_another_simulator_is_the_nominal_one(tmp_path):
    """A simulator with viscous friction of its own replied to one motion; the robot has dry friction beside it."""
    arm = machine(tmp_path / "lift.urdf", conditions={"a": {"simulator": "gazebo"}, "b": {"simulator": "robot"}})
    reply = recorded("a", 0.0, coulomb=(0.0, 0.0))
    verdict = diagnose(arm, [reply, recorded("b", 0.7, coulomb=(8.0, 0.0))]).verdict
    found = changes(verdict)
    assert set(found) == {("coulomb_friction", "lift")}
    assert found["coulomb_friction", "lift"].parameters["force"].value == pytest.approx(8.0, rel=0.06)
    assert {(c.effect, c.actuator) for c in verdict.causes if not c.condition} == {
        ("viscous_friction", "lift"),
        ("viscous_friction", "swing"),
    }
    assert any("simulator robot against gazebo" in n for n in verdict.notes)


def test_nothing_changed_is_said(tmp_path):
    arm = machine(tmp_path / "lift.urdf", conditions={"a": {"day": "Monday"}, "b": {"day": "Friday"}})
    verdict = diagnose(arm, [recorded("a", 0.0), recorded("b", 0.7)]).verdict
    assert not changes(verdict)
    assert any("day Friday against Monday, all else held common: nothing changed" in n for n in verdict.notes)


@pytest.mark.parametrize("joint", [0, 1])
def test_a_change_of_the_size_that_would_have_shown_is_seen(tmp_path, joint):
    arm = machine(tmp_path / "lift.urdf", conditions={"a": {"day": "Monday"}, "b": {"day": "Friday"}})
    alike, name = diagnose(arm, [recorded("a", 0.0), recorded("b", 0.7)]).verdict, ("lift", "swing")[joint]
    said = next(n for n in alike.notes if "would have shown" in n)
    number, milli = re.search(rf"Coulomb friction on {name}, force by (\S+) (m?)N", said).groups()
    more = np.array([8.0, 0.5]) + float(number) * (1e-3 if milli else 1.0) * np.eye(2)[joint]
    found = changes(diagnose(arm, [recorded("a", 0.0), recorded("b", 0.7, coulomb=tuple(more))]).verdict)
    assert ("coulomb_friction", name) in found and found["coulomb_friction", name].parameters["force"].value > 0.0


def test_what_the_short_reference_left_out_is_no_change(tmp_path):
    """Viscous friction of the swing is in both runs; the reference of 3 s is too short to tell it."""
    arm = machine(tmp_path / "lift.urdf", conditions={"a": {"day": "Monday"}, "b": {"day": "Friday"}})
    rows = []
    for name, seed, seconds in (("a", 0.0, 3.0), ("b", 0.7, 24.0)):
        q, v, a = motion(seconds, seed=seed)
        force = needed(q, v, a, 0.0, 0.05, -L) + friction(v, coulomb=(8.0, 0.5), viscous=(4.0, 0.1))
        rows.append(run_of(q, force, name=name))
    verdict = diagnose(arm, rows).verdict
    assert not changes(verdict)
    common = {(c.effect, c.actuator): c.parameters for c in verdict.causes}
    assert common["viscous_friction", "swing"]["extra"].value == pytest.approx(0.1, rel=0.05)
    assert common["coulomb_friction", "swing"]["force"].value == pytest.approx(0.5, rel=0.05)


def test_conditions_that_come_together_are_said(tmp_path):
    tags = {"a": {"controller": "old", "payload": "none"}, "b": {"controller": "new", "payload": "cup"}}
    arm = machine(tmp_path / "lift.urdf", conditions=tags)
    notes = arm.audit([recorded("a", 0.0), recorded("b", 0.7)])
    assert any("nothing tells them apart" in n for n in notes)


@pytest.mark.parametrize(
    ("tags", "words"),
    [({"c": {"day": "1"}}, "no run 'c'"), ({"a": {"day": "1"}}, "run 'b' has no day")],
)
def test_conditions_that_fit_no_run_are_named(tmp_path, tags, words):
    arm = machine(tmp_path / "lift.urdf", conditions=tags)
    with pytest.raises(MachineError, match=words):
        arm.audit([recorded("a", 0.0), recorded("b", 0.7)])


def test_the_change_of_an_axis_beside_its_common_friction():
    from slides import driven
    from slides import machine as slide
    from slides import run_of as record

    runs = [record(driven(8.0, coulomb=5.0, offset=x)) for x in (0.0, 3.0)]
    runs = [type(r)(name, r.period, r.signals) for name, r in zip("ab", runs, strict=True)]
    axes = slide()
    tagged = axes.described.model_copy(update={"conditions": {"a": {"posture": "flat"}, "b": {"posture": "tilted"}}})
    verdict = diagnose(type(axes)(tagged), runs).verdict
    found = changes(verdict)
    assert set(found) == {("gravity_load", "slide")}
    assert found["gravity_load", "slide"].parameters["force"].value == pytest.approx(3.0, rel=0.06)
    assert np.isclose(next(c for c in verdict.causes if not c.condition).parameters["force"].value, 5.0, rtol=0.06)


def test_two_encoders_with_a_zero_of_their_own_are_contrasted():
    """The zero between two encoders is a term of every fit, on the runs of the reference too."""
    from slides import columns
    from slides import machine as slide

    t, noise = np.arange(8000) * 0.002, np.random.default_rng(0)
    position = 0.04 * np.sin(1.3 * t) + 0.015 * np.sin(4.1 * t)
    axes = slide(signals=columns("position", "reference", "load"), command_law={"kind": "position"}, mass=None)
    tagged = axes.described.model_copy(update={"conditions": {"a": {"belt": "old"}, "b": {"belt": "new"}}})
    runs = []
    for name, scale in (("a", 1.0), ("b", 1.002)):
        load = scale * position + 3e-4 + noise.normal(0.0, 2e-6, len(t))
        runs.append(AxesRun(name, 0.002, {"slide": {"position": position, "reference": position, "load": load}}))
    found = changes(diagnose(type(axes)(tagged), runs).verdict)
    assert found["lead_error", "slide"].parameters["relative"].value == pytest.approx(0.002, rel=0.05)
    assert found["lead_error", "slide"].condition == "belt new"
