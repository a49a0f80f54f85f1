"""A lift with a pendulum, both joints moving at once: what the engine says of it."""

from itertools import pairwise

import numpy as np
import pytest
from lifts import L, described, friction, machine, motion, needed, run_of, values
from sher3_chain.manipulator.identification.gains import backwards
from sher3_chain.readings.slip_of_unit import Share
from sher3_diagnosis import diagnose
from sher3_machines import MachineError

Q, V, A = motion()


def verdict(path, effort, **changes):
    return diagnose(machine(path, **changes), [run_of(Q, effort)]).verdict


@pytest.fixture
def path(tmp_path):
    return tmp_path / "lift.urdf"


def test_a_healthy_arm_has_no_gap(path):
    assert verdict(path, needed(Q, V, A)).status == "no_gap"


def test_friction_of_both_joints_under_weight_and_coupling(path):
    found = verdict(path, needed(Q, V, A) + friction(V, (8.0, 0.5), (20.0, 0.4)))
    value = values(found)
    assert found.status == "attributed"
    assert {(c.effect, c.actuator) for c in found.causes} == {
        (effect, joint) for effect in ("coulomb_friction", "viscous_friction") for joint in ("lift", "swing")
    }
    assert value["coulomb_friction", "lift", "force"] == pytest.approx(8.0, rel=0.06)
    assert value["viscous_friction", "lift", "extra"] == pytest.approx(20.0, rel=0.06)
    assert value["coulomb_friction", "swing", "force"] == pytest.approx(0.5, rel=0.06)
    assert value["viscous_friction", "swing", "extra"] == pytest.approx(0.4, rel=0.06)


def test_a_slow_log_reverses_between_its_samples(path):
    """Ten samples a second: a friction that turned at the next sample was told with an effort 54 ms late."""
    q, v, a = motion(60.0, period=0.1)
    run = run_of(q, needed(q, v, a) + friction(v, (30.0, 3.0)), period=0.1)
    found = diagnose(machine(path, time={"rate": 10.0}), [run]).verdict
    assert {(c.effect, c.actuator) for c in found.causes} == {
        ("coulomb_friction", "lift"),
        ("coulomb_friction", "swing"),
    }
    assert values(found)["coulomb_friction", "swing", "force"] == pytest.approx(3.0, rel=0.02)


def test_a_payload_on_the_pendulum_is_one_cause_of_both_joints(path):
    """0.5 kg at the height of the pendulum's own centre, 5 cm in front of it."""
    found = verdict(path, needed(Q, V, A, 0.5, 0.05, -L) + friction(V, (8.0, 0.5)))
    value = values(found)
    assert {c.effect for c in found.causes} == {"payload_mass", "coulomb_friction"}
    assert value["payload_mass", "pendulum", "mass"] == pytest.approx(0.5, rel=0.03)
    assert value["payload_mass", "pendulum", "x"] == pytest.approx(0.05, abs=0.01)
    assert value["payload_mass", "pendulum", "z"] == pytest.approx(-L, abs=0.02)


def test_a_payload_many_times_its_link_is_no_other_unit(path):
    """The model's pendulum has 0.2 kg, the robot carries 1.8 kg more: ten times the torque, and the lift feels it."""
    text = described(path).model and path.read_text().replace('mass value="2.0"', 'mass value="0.2"')
    found = verdict(path, needed(Q, V, A) + friction(V, (8.0, 0.5)), text=text)
    assert not any("times what the model needs" in note for note in found.notes)
    assert values(found)["payload_mass", "pendulum", "mass"] == pytest.approx(1.8, rel=0.05)


def test_a_spring_and_a_gear_loss(path):
    """10 N/m on the lift; a tenth of the torque lost in the gear of the swing."""
    nominal = needed(Q, V, A)
    effort = nominal + np.stack([10.0 * (Q[:, 0] - 0.1), 0.1 * np.abs(nominal[:, 1]) * np.tanh(V[:, 1] / 1e-3)], axis=1)
    value = values(verdict(path, effort))
    assert value["spring_torque", "lift", "stiffness"] == pytest.approx(10.0, rel=0.05)
    assert value["spring_torque", "lift", "rest"] == pytest.approx(0.1, abs=0.03)
    assert value["gear_loss", "swing", "share"] == pytest.approx(0.1, rel=0.1)


def test_a_drive_gain_and_a_rotor(path):
    nominal = needed(Q, V, A)
    effort = np.stack([nominal[:, 0] / 1.1, nominal[:, 1] + 0.05 * A[:, 1]], axis=1)
    value = values(verdict(path, effort))
    assert value["torque_constant", "lift", "relative"] == pytest.approx(0.1, rel=0.05)
    assert value["rotor_inertia", "swing", "inertia"] == pytest.approx(0.05, rel=0.05)


def test_an_unknown_gain_is_found_and_what_hides_in_it_is_said(path):
    """2.5 N m an ampere on the swing, whose effort was recorded with the opposite sign."""
    effort = (needed(Q, V, A) + friction(V, (0.0, 0.5))) / np.array([1.0, -2.5])
    found = verdict(path, effort, joint={"swing": {"gain": "unknown"}})
    cause = next(c for c in found.causes if c.actuator == "swing")
    assert cause.effect == "coulomb_friction"
    assert cause.parameters["force"].value == pytest.approx(0.2, rel=0.06)
    assert cause.parameters["force"].unit == "eu"
    told = " ".join(found.notes)
    assert "swing: effort recorded with the opposite sign" in told
    assert "gain, weight and payload are confounded" in told
    share = next(n for n in found.notes if "per N m" in n)
    assert float(share.split()[1]) == pytest.approx(0.4, rel=0.01)


@pytest.mark.parametrize(
    ("shares", "turned"),
    [
        ({"a": -1.2, "b": -0.3}, ("a", "b")),  # one controller, one sign: the doubtful one follows
        ({"a": -1.2, "b": -0.3, "c": 1.1}, ("a",)),  # signs differ by joint: each by itself
        ({"a": 1.2, "b": -0.3}, ()),
        ({"b": -0.3}, ()),
        ({"a": -1.2, "b": 0.0}, ("a", "b")),  # neither its weight nor its friction tells a sign
    ],
)
def test_a_doubtful_sign_follows_those_of_the_other_joints(shares, turned):
    found = {name: Share(x, 0.01, x < 0.0) for name, x in shares.items()}
    assert backwards(found, set(shares)) == turned


@pytest.mark.parametrize(
    ("share", "work", "sense"),
    [(0.0, 9.0, 1), (0.0, -9.0, -1), (0.0, 1.0, 0), (119.0, -9.0, -1), (-1.1, -9.0, -1), (-1.1, 9.0, 0)],
)
def test_friction_tells_a_sign_where_the_model_does_not(share, work, sense):
    """A share of 119 is that of a link that the model hardly has: any number; one of -1.1 may be a spring's doing."""
    assert Share(share, 0.01, share < 0.0, work).sense(stated=True) == sense


def test_an_arm_that_hangs_upside_down_turns_no_current(path):
    """Its weights have the other sign than the model's, whatever an ampere is; friction takes work as recorded."""
    assert Share(-0.11, 0.01, True, 9.0).sense(stated=False) == 0
    upside = needed(Q, V, A) - 2.0 * needed(Q, 0.0 * V, 0.0 * A)
    both = {joint: {"gain": "unknown"} for joint in ("lift", "swing")}
    found = verdict(path, (upside + friction(V, (8.0, 2.0))) / 2.5, joint=both)
    assert not any("opposite sign" in note for note in found.notes)


def test_a_spring_stronger_than_the_inertia_turns_no_effort(path):
    """60 N/m on six kilograms that swing at 0.2 Hz: the force is in proportion to minus the acceleration."""
    effort = needed(Q, V, A) + friction(V, (8.0, 0.5)) + np.stack([60.0 * (Q[:, 0] - 0.1), 0.0 * Q[:, 1]], axis=1)
    found = verdict(path, effort)
    assert not any("opposite sign" in note for note in found.notes)
    assert values(found)["spring_torque", "lift", "stiffness"] == pytest.approx(60.0, rel=0.05)
    assert values(found)["coulomb_friction", "lift", "force"] == pytest.approx(8.0, rel=0.06)


@pytest.mark.parametrize("size", [0.2, 0.5, 1.5])
def test_a_constant_is_no_cable_and_a_cable_has_a_span(path, size):
    """A force of a zero that is off, on a joint with friction: a cable takes it up with no span of its own."""
    effort = needed(Q, V, A) + friction(V, (8.0, 0.5), (20.0, 0.4)) + np.array([0.0, size])
    found = verdict(path, effort)
    causes = {c.effect for c in found.causes if c.actuator == "swing"}
    assert "gravity_load" in causes and not causes & {"cable_torque", "spring_torque"}


def test_gains_that_differ_by_run_are_found_run_by_run(path):
    """0.4 and 1.7 units a newton metre; the second run has the opposite sign too. The friction is common to both."""
    arm, runs = machine(path, joint={"swing": {"gain": "per_run"}}), []
    for name, units, seed in (("a", 0.4, 0.0), ("b", -1.7, 0.7)):
        q, v, a = motion(16.0, seed=seed)
        runs.append(run_of(q, (needed(q, v, a) + friction(v, (0.0, 0.5))) * np.array([1.0, units]), name=name))
    found = diagnose(arm, runs).verdict
    (cause,) = found.causes
    assert found.status == "attributed" and (cause.effect, cause.actuator) == ("coulomb_friction", "swing")
    assert cause.parameters["force"].value == pytest.approx(0.5, rel=0.06) and cause.parameters["force"].unit == "N*m"
    note = next(n for n in found.notes if "run by run" in n)
    told = {word: float(x.strip(",;")) for word, x in pairwise(note.split()) if word in ("a", "b")}
    assert told["a"] == pytest.approx(0.4, rel=0.01) and told["b"] == pytest.approx(-1.7, rel=0.01)


def test_a_cable_pulls_over_position_going_and_coming_alike(path):
    """A cable that stiffens towards one end: no line, so no spring; 3 (q - 0.2)^2 N m on the swing."""
    effort = needed(Q, V, A) + np.stack([0.0 * Q[:, 0], 3.0 * (Q[:, 1] - 0.2) ** 2], axis=1)
    found = verdict(path, effort)
    (cause,) = found.causes
    assert (cause.effect, cause.actuator) == ("cable_torque", "swing") and cause.closure.value > 0.98


def test_a_dead_effort_is_named_and_the_other_joint_judged(path):
    effort = needed(Q, V, A) + friction(V, (8.0, 0.0))
    run = run_of(Q, effort)
    run.signals["swing"]["effort"][:] = 0.0
    found = diagnose(machine(path), [run]).verdict
    assert {(c.effect, c.actuator) for c in found.causes} == {("coulomb_friction", "lift")}
    assert any("swing.effort reads 0 in 100%" in n for n in found.notes)
    assert any(n.startswith("not judged") and "swing" in n for n in found.notes)


def test_an_arm_of_which_nothing_can_be_judged_is_refused(path):
    run = run_of(Q, 0.0 * Q, noise=0.0)
    with pytest.raises(MachineError, match="no joint can be judged"):
        diagnose(machine(path), [run])


def test_friction_behind_a_coupling_belongs_to_the_motor(path):
    """The second motor moves with both joints: its friction would be booked on the wrong joint without the coupling."""
    travel = np.array([[1.0, 0.0], [1.0, 0.5]])
    motors = needed(Q, V, A) @ np.linalg.inv(travel)  # tau_joint = R^T tau_motor
    motors = motors + friction(V @ travel.T, (0.0, 3.0))
    found = verdict(path, motors @ travel, coupling=travel.tolist(), joint={"swing": {"motion": "linear"}})
    assert {(c.effect, c.actuator) for c in found.causes} == {("coulomb_friction", "swing")}
    assert values(found)["coulomb_friction", "swing", "force"] == pytest.approx(3.0, rel=0.06)


@pytest.mark.parametrize("gear", [1.0, 20.0, -48.0])
def test_places_of_the_motors_behind_a_coupling_are_those_of_the_joints(path, gear):
    """A drive logs its motor: travel and effort are on its side, geared and coupled, and friction is the motor's."""
    travel = np.array([[1.0, 0.0], [1.0, 0.5]]) * gear
    motors = needed(Q, V, A) @ np.linalg.inv(travel) + friction(V @ travel.T, (0.0, 3.0 / abs(gear)))
    run = run_of(Q @ travel.T, motors, noise=0.02 / abs(gear))
    sides = {"coupling": travel.tolist(), "effort_of": "motors", "position_of": "motors"}
    found = diagnose(machine(path, joint={"swing": {"motion": "linear"}}, **sides), [run]).verdict
    assert {(c.effect, c.actuator) for c in found.causes} == {("coulomb_friction", "swing")}
    assert values(found)["coulomb_friction", "swing", "force"] == pytest.approx(3.0 / abs(gear), rel=0.06)


def test_identified_inertias_leave_the_friction(path):
    """The model's pendulum is 30 % too light: with inertias free, what is left is friction alone."""
    text = described(path).model and path.read_text().replace('mass value="2.0"', 'mass value="1.4"')
    effort = needed(Q, V, A) + friction(V, (8.0, 0.5))
    found = verdict(path, effort, text=text, inertias="identified")
    assert {c.effect for c in found.causes} == {"coulomb_friction"}
    assert values(found)["coulomb_friction", "lift", "force"] == pytest.approx(8.0, rel=0.06)
    assert any("not looked for" in n for n in found.notes)


def test_inertias_found_of_amperes_need_no_newton_metres(path):
    """2.5 N m (N) an ampere, which nobody states: bodies in the unit of the effort, and friction in it."""
    text = described(path).model and path.read_text().replace('mass value="2.0"', 'mass value="1.4"')
    amperes = (needed(Q, V, A) + friction(V, (8.0, 0.5))) / 2.5
    both = {joint: {"gain": "unknown"} for joint in ("lift", "swing")}
    found = verdict(path, amperes, text=text, inertias="identified", joint=both)
    assert {c.effect for c in found.causes} == {"coulomb_friction"}
    assert values(found)["coulomb_friction", "lift", "force"] == pytest.approx(3.2, rel=0.06)
    assert values(found)["coulomb_friction", "swing", "force"] == pytest.approx(0.2, rel=0.1)
