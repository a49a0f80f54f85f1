"""A healthy arm of MuJoCo has no gap to its own model: losses, drives and the step of the integrator are in it."""

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from drawn_arms import drawn_xml, logged
from sher3_chain.manipulator.draft import draft_arm
from sher3_diagnosis import diagnose
from sher3_machines import import_case, open_case


def verdict_of(folder, found, forces):
    """Return the verdict on a log whose columns have MuJoCo's names, through the files a user would write."""
    (folder / "arm.xml").write_text(found.xml)
    columns = {"time": found.time, "ctrl": found.ctrl, "qpos": found.qpos, "qvel": found.qvel}
    np.savez(folder / "log.npz", **columns, **({"actuator_force": found.actuator_force} if forces else {}))
    (folder / "arm.yaml").write_text(draft_arm(folder / "log.npz", folder / "arm.xml").text)
    import_case([folder / "log.npz"], folder / "arm.yaml", folder / "case")
    return diagnose(*open_case(folder / "case")).verdict


def cases(seeds):
    """Return seed, whether the actuators are servos, and whether their force was recorded."""
    return [(seed, seed % 3 != 2, seed % 2 == 0) for seed in seeds]


@pytest.mark.parametrize(("seed", "servo", "forces"), cases((1, 2, 4)))
def test_a_healthy_arm_has_no_gap(seed, servo, forces, tmp_path):
    xml = drawn_xml(np.random.default_rng(seed), servo)
    assert verdict_of(tmp_path, logged(xml, seed), forces).status == "no_gap"


@pytest.mark.parametrize("forces", [True, False], ids=["effort", "servo law"])
def test_what_the_robot_loses_beside_its_model_is_named(forces, tmp_path):
    xml = drawn_xml(np.random.default_rng(6), joints=2)
    nominal = ElementTree.fromstring(xml)
    (elbow,) = [j for j in nominal.iter("joint") if j.get("name") == "shoulder"]
    elbow.set("frictionloss", str(float(elbow.get("frictionloss")) + 1.2))
    found = logged(ElementTree.tostring(nominal, encoding="unicode"), 6)
    verdict = verdict_of(tmp_path, replace(found, xml=xml), forces)
    (cause,) = verdict.causes
    assert (cause.effect, cause.actuator) == ("coulomb_friction", "shoulder")
    assert cause.parameters["force"].value == pytest.approx(1.2, rel=0.05)


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_fifty_healthy_arms(tmp_path):
    wrong = {}
    for seed, servo, forces in cases(range(200, 250)):
        folder = tmp_path / str(seed)
        folder.mkdir()
        verdict = verdict_of(folder, logged(drawn_xml(np.random.default_rng(seed), servo), seed), forces)
        if verdict.status != "no_gap":
            wrong[seed] = [f"{c.effect} on {c.actuator}" for c in verdict.causes] or verdict.status
    assert not wrong
