"""Servos of an arm of MuJoCo that do not do what the model's drives say: late, weak, and as they should."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
import sher3.gap as gap
from drawn_arms import NOISE, drawn_xml, served
from sher3_diagnosis.verdict import Parameter

SEED, SECONDS, PLACE = 41, 8.0, 1


def logged(share: float = 1.0, late: int = 0, rubs: float = 0.0, forces: bool = True, stiff: float = 1.0) -> gap.Answer:
    """Diagnose a log of an arm of which one servo gives a share of its force, or follows its control steps late.

    Its joint rubs by more than its model says, N m and N m/(rad/s); the log has forces, or has not. `stiff` is a factor
    of the gain of its position alone.
    """
    xml = drawn_xml(np.random.default_rng(SEED), servo=True, joints=3)
    nominal = mujoco.MjModel.from_xml_string(xml)
    spec = mujoco.MjSpec.from_string(xml)
    spec.actuators[PLACE].gainprm[0] *= share * stiff
    spec.actuators[PLACE].biasprm[1:3] *= share * np.array([stiff, 1.0])
    spec.joints[PLACE].frictionloss += rubs
    spec.joints[PLACE].damping[0] += rubs
    model, rng = spec.compile(), np.random.default_rng(SEED)
    stamps = np.arange(round(SECONDS / model.opt.timestep)) * model.opt.timestep
    pace, phase = rng.uniform(0.2, 0.8, (3, 2)), rng.uniform(0.0, 2.0 * np.pi, (3, 2))
    asked = 0.3 * np.sin(2.0 * np.pi * pace * stamps[:, None, None] + phase).sum(axis=2)
    ctrl = asked * np.minimum(1.0, stamps)[:, None] * nominal.actuator_gear[:, 0]
    qpos, force = served(model, ctrl, PLACE, late)
    qpos = qpos + NOISE * rng.standard_normal(qpos.shape)
    known = {"actuator_force": force} if forces else {}
    return gap.diagnose(xml, {"time": stamps, "ctrl": ctrl, "qpos": qpos, **known})


def test_a_servo_as_modelled_has_no_gap():
    assert logged().status == "no_gap"


def test_a_weak_servo_is_a_gain_of_its_law():
    answer = logged(share=0.9)
    [cause] = answer.causes
    assert (answer.status, cause.effect, cause.actuator) == ("attributed", "controller_gain", "shoulder")
    assert cause.parameters["relative"].value == pytest.approx(-0.1, abs=0.002)


@pytest.mark.parametrize("stiff", [0.6, 1.33, 2.0])
def test_one_wrong_gain_of_a_servo_is_that_gain(stiff):
    answer = logged(stiff=stiff)
    [cause] = answer.causes
    assert (answer.status, cause.effect, cause.actuator) == ("attributed", "controller_gain", "shoulder")
    assert cause.parameters["position_relative"].value == pytest.approx(stiff - 1.0, abs=0.01)
    assert not any("opposite sign" in note for note in answer.notes)


def test_a_control_that_acts_late_is_a_delay_of_its_reference():
    answer = logged(late=10)
    step = mujoco.MjModel.from_xml_string(drawn_xml(np.random.default_rng(SEED), servo=True, joints=3)).opt.timestep
    [cause] = answer.causes
    assert (answer.status, cause.effect, cause.actuator) == ("attributed", "command_delay", "shoulder")
    assert cause.parameters["reference_delay"].value == pytest.approx(10 * step, rel=0.02)


def sizes(answer: gap.Answer) -> dict[str, Parameter]:
    """Return effect -> its first parameter; all of them sit on the joint of the servo."""
    assert {c.actuator for c in answer.causes} == {"shoulder"}
    return {c.effect: next(iter(c.parameters.values())) for c in answer.causes}


def test_a_late_command_beside_friction_is_told_without_recorded_forces():
    """Taken one after the other, the delay takes up half of the friction, and nothing explains the rest."""
    answer = logged(late=10, rubs=0.8, forces=False)
    found = sizes(answer)
    assert answer.status == "attributed" and found.keys() == {"command_delay", "coulomb_friction", "viscous_friction"}
    assert found["coulomb_friction"].low < 0.8 < found["coulomb_friction"].high


def test_forces_beside_a_weak_servo_are_those_that_act():
    """A servo of seven tenths of its force needs 10/7 of it in its law for the same friction."""
    found = sizes(logged(share=0.7, rubs=0.8, forces=False))
    assert found["torque_constant"].value == pytest.approx(-0.3, abs=0.01)
    for friction in ("coulomb_friction", "viscous_friction"):
        assert found[friction].low < 0.8 < found[friction].high
