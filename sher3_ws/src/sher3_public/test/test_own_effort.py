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


def weakened():
    """Return a model, its joint whose gains are 20 % less in the machine, and the log of the machine."""
    xml = arm("implicitfast")
    root = ElementTree.fromstring(xml)
    weak = next(iter(root.iter("position")))
    weak.attrib.update({name: str(0.8 * float(weak.get(name))) for name in ("kp", "kv")})
    return xml, weak.get("joint"), logged(ElementTree.tostring(root, encoding="unicode"), SEEDS["implicitfast"])


@pytest.mark.parametrize("method", SEEDS)
def test_efforts_alone_of_a_healthy_simulator_are_no_gap(method):
    xml = arm(method)
    found = diagnosed(xml, logged(xml, SEEDS[method]))
    assert found.status == "no_gap" and "simulator's own" in " ".join(found.guessed)


def test_efforts_alone_of_a_servo_whose_speed_settles_within_a_few_steps():
    xml = drawn_xml(np.random.default_rng(716))
    assert "RK4" in xml and diagnosed(xml, logged(xml, 716)).status == "no_gap"


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


def test_a_weak_servo_of_a_simulator_is_a_gain_and_no_rotor():
    """Its own effort is off from the law of the model; that of the other joints says whose the efforts are."""
    xml, joint, log = weakened()
    (cause,) = diagnosed(xml, log, log.ctrl).causes
    assert (cause.effect, cause.actuator) == ("controller_gain", joint)
    assert cause.parameters["relative"].value == pytest.approx(-0.2, abs=0.005)


JUMPING = """<mujoco><option timestep="0.001" integrator="implicitfast"/><worldbody><body>
<joint name="wrist" axis="0 0 1" armature="0.002" damping="0.05"/><geom type="capsule" fromto="0 0 0 .2 0 0" size=".02"
mass=".3"/></body></worldbody><actuator><position joint="wrist" kp="240" kv="16"/></actuator></mujoco>"""


def test_a_start_with_a_jump_at_a_thousand_samples_a_second_is_still_the_simulators_own():
    """The first samples are faster than what readings are smoothed over; what is left there is no other drive."""
    model = mujoco.MjModel.from_xml_string(JUMPING)
    state, time = mujoco.MjData(model), 0.001 * np.arange(4000)
    told = 0.4 + 0.5 * np.sin(3.0 * time) + 0.2 * np.sin(7.0 * time)
    rows = []
    for u in told:
        state.ctrl[0] = u
        mujoco.mj_forward(model, state)
        rows.append([state.qpos[0], state.actuator_force[0]])
        mujoco.mj_step(model, state)
    q, force = np.array(rows).T
    q = q + 1e-5 * np.random.default_rng(1).normal(size=len(q))
    found = gap.diagnose(JUMPING, time, told[:, None], q[:, None], force[:, None])
    assert found.status == "no_gap" and "a simulator's own" in " ".join(found.guessed)


def test_what_is_stated_holds():
    xml = arm("RK4")
    assert diagnosed(xml, logged(xml, SEEDS["RK4"]), simulated=False).status != "no_gap"


def test_weak_gains_whose_force_was_not_recorded_may_as_well_be_a_weak_drive():
    xml, joint, log = weakened()
    (cause,) = gap.diagnose(xml, log.time, log.ctrl, log.qpos).causes
    assert (cause.effect, cause.actuator) == ("torque_constant", joint)
    assert "controller_gain" in cause.rivals and cause.parameters["relative"].value == pytest.approx(-0.2, abs=0.01)
