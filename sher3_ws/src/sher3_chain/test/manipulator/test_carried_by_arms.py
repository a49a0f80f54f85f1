"""A known mass on an arm: it is no cause, it tells a drive's gain from a weight, and a verdict proposes it."""

import re

import numpy as np
import pytest
from lifts import friction, machine, motion, needed, run_of
from sher3_diagnosis import diagnose
from sher3_machines import MachineError

PACE, AT = 0.2, (0.1, 0.1, 0.1)


def slow(name="first", gain=1.0, mass=0.0):
    """A lift with a pendulum that moves too slowly to feel inertia; the drive of the pendulum gives `gain`."""
    q, v, a = motion(40.0)
    v, a = PACE * v, PACE**2 * a
    force = needed(q, v, a, mass, AT[0], AT[2]) + friction(v, (2.0, 0.1))
    return run_of(q, force / [1.0, gain], period=0.005 / PACE, name=name)


def carrying(path, mass, **run):
    return machine(path, carried={run.get("name", "second"): {"mass": mass, "link": "pendulum", "centre": AT}})


def test_gain_and_weight_are_open_and_a_known_mass_on_the_last_link_is_proposed(tmp_path):
    verdict = diagnose(machine(tmp_path / "lift.urdf"), [slow(gain=0.8)]).verdict
    asked = verdict.next_experiment
    assert {"torque_constant", "gravity_load"} <= set(asked.separates)
    assert re.match(r"a known mass of 0\.9 kg on pendulum", asked.added)
    assert asked.expected_odds > 0.9


def test_records_without_and_with_the_mass_are_judged_as_one(tmp_path):
    runs = [slow(gain=0.8), slow("second", gain=0.8, mass=0.9)]
    verdict = diagnose(carrying(tmp_path / "lift.urdf", 0.9), runs).verdict
    (cause,) = (c for c in verdict.causes if c.family != "friction")
    assert (cause.effect, cause.actuator) == ("torque_constant", "swing")
    assert cause.parameters["relative"].value == pytest.approx(-0.2, abs=0.01)
    assert next(p for p in verdict.places if p.actuator == "swing").answers[0].probability > 0.95


def test_what_was_carried_is_no_payload_and_its_weight_acts_from_outside(tmp_path):
    arm, bare = carrying(tmp_path / "lift.urdf", 0.9, name="first"), machine(tmp_path / "lift.urdf")
    run = slow(mass=0.9)
    assert not {c.effect for c in diagnose(arm, [run]).verdict.causes} & {"payload_mass", "gravity_load"}
    with_mass, without = (m.gather([run])[0].records[0] for m in (arm, bare))
    np.testing.assert_allclose(with_mass.path.gravity, without.path.gravity)
    np.testing.assert_allclose(with_mass.path.contact_force[:, with_mass.row("lift")], -0.9 * 9.81)
    assert not without.path.contact_force.any()


def test_what_was_carried_names_a_run_and_a_link_beside_the_models_inertias(tmp_path):
    known = {"mass": 0.9, "link": "pendulum", "centre": AT}
    path = tmp_path / "lift.urdf"
    with pytest.raises(MachineError, match="names no run"):
        machine(path, carried={"other": known}).gather([slow()])
    with pytest.raises(MachineError, match="names no link"):
        machine(path, carried={"first": {**known, "link": "hook"}}).gather([slow()])
    with pytest.raises(ValueError, match="inertias: nominal"):
        machine(path, carried={"first": known}, inertias="identified")
