"""Efforts without controls: a simulator's own ones are larger than those that acted, measured ones are not."""

import re
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
import sher3.gap as gap
from drawn_arms import drawn_xml, logged

SEEDS = {"implicit": 704, "implicitfast": 708, "Euler": 702, "RK4": 700}


def arm(method):
    xml = drawn_xml(np.random.default_rng(SEEDS[method]))
    return re.sub('integrator="[a-zA-Z0-9]+"', f'integrator="{method}"', xml)


def diagnosed(xml, log, control=None, **stated):
    gear = mujoco.MjModel.from_xml_string(xml).actuator_gear[:, 0]
    return gap.diagnose(xml, log.time, control, log.qpos, log.actuator_force * gear, **stated)


@pytest.mark.parametrize("method", SEEDS)
def test_efforts_alone_of_a_healthy_simulator_are_no_gap(method):
    xml = arm(method)
    found = diagnosed(xml, logged(xml, SEEDS[method]))
    assert found.status == "no_gap" and "simulator's own" in " ".join(found.guessed)


def test_a_place_and_a_speed_within_the_step_of_runge_and_kutta():
    """Without the half step of the control the law is off by kp * dt / 2 * d(ctrl)/dt: 0.8 N m at 2 rad/s."""
    xml = arm("RK4")
    log = logged(xml, SEEDS["RK4"])
    assert diagnosed(xml, log, log.ctrl).status == "no_gap"
    assert gap.diagnose(xml, log.time, log.ctrl, log.qpos).status == "no_gap"


def test_a_rotor_beside_what_the_step_adds_is_named_with_its_own_size():
    xml = arm("implicit")
    root = ElementTree.fromstring(xml)
    shoulder = list(root.iter("joint"))[1]
    shoulder.set("armature", str(float(shoulder.get("armature")) + 0.03))
    found = diagnosed(xml, logged(ElementTree.tostring(root, encoding="unicode"), 704))
    (cause,) = found.causes
    assert (cause.effect, cause.actuator) == ("rotor_inertia", "shoulder")
    assert cause.parameters["inertia"].value == pytest.approx(0.03, rel=0.05)


def test_what_is_stated_holds():
    xml = arm("RK4")
    assert diagnosed(xml, logged(xml, SEEDS["RK4"]), simulated=False).status != "no_gap"
