"""Servos of an arm of MuJoCo that do not do what the model's drives say: late, weak, and as they should."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
import sher3.gap as gap
from drawn_arms import NOISE, drawn_xml, served

SEED, SECONDS, PLACE = 41, 8.0, 1


def logged(share: float = 1.0, late: int = 0) -> gap.Answer:
    """Diagnose a log of an arm of which one servo gives a share of its force, or follows its control steps late."""
    xml = drawn_xml(np.random.default_rng(SEED), servo=True, joints=3)
    nominal = mujoco.MjModel.from_xml_string(xml)
    spec = mujoco.MjSpec.from_string(xml)
    spec.actuators[PLACE].gainprm[0] *= share
    spec.actuators[PLACE].biasprm[1:3] *= share
    model, rng = spec.compile(), np.random.default_rng(SEED)
    stamps = np.arange(round(SECONDS / model.opt.timestep)) * model.opt.timestep
    pace, phase = rng.uniform(0.2, 0.8, (3, 2)), rng.uniform(0.0, 2.0 * np.pi, (3, 2))
    asked = 0.3 * np.sin(2.0 * np.pi * pace * stamps[:, None, None] + phase).sum(axis=2)
    ctrl = asked * np.minimum(1.0, stamps)[:, None] * nominal.actuator_gear[:, 0]
    qpos, force = served(model, ctrl, PLACE, late)
    qpos = qpos + NOISE * rng.standard_normal(qpos.shape)
    return gap.diagnose(xml, {"time": stamps, "ctrl": ctrl, "qpos": qpos, "actuator_force": force})


def test_a_servo_as_modelled_has_no_gap():
    assert logged().status == "no_gap"


def test_a_weak_servo_is_a_gain_of_its_law():
    answer = logged(share=0.9)
    [cause] = answer.causes
    assert (answer.status, cause.effect, cause.actuator) == ("attributed", "controller_gain", "shoulder")
    assert cause.parameters["relative"].value == pytest.approx(-0.1, abs=0.002)


def test_a_control_that_acts_late_is_a_delay_of_its_reference():
    answer = logged(late=10)
    step = mujoco.MjModel.from_xml_string(drawn_xml(np.random.default_rng(SEED), servo=True, joints=3)).opt.timestep
    [cause] = answer.causes
    assert (answer.status, cause.effect, cause.actuator) == ("attributed", "command_delay", "shoulder")
    assert cause.parameters["reference_delay"].value == pytest.approx(10 * step, rel=0.02)
