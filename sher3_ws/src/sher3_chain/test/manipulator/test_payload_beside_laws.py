"""A payload beside a spring and a rotor of other joints: each has its own, and the spring of a model is no weight."""

import mujoco
import numpy as np
import pytest
import sher3.gap as gap
from drawn_arms import drawn_xml, log_of_servos


def test_a_payload_a_spring_and_a_rotor_are_told_together():
    """Without springs and rotors beside it a payload takes their forces for its own, or they take its."""
    rng = np.random.default_rng([9110, 3])
    xml = drawn_xml(rng, servo=True, joints=3, methods=["implicitfast"]).replace('gravcomp="1"', "")
    spec = mujoco.MjSpec.from_string(xml)
    spec.joints[1].stiffness[0] += 2.0
    spec.joints[2].armature += 0.018
    ball = {"type": mujoco.mjtGeom.mjGEOM_SPHERE, "size": [0.01, 0, 0], "mass": 0.3}
    spec.bodies[-1].add_body(pos=[0.25, 0, 0]).add_geom(**ball, contype=0, conaffinity=0)
    answer = gap.diagnose(xml, log_of_servos(spec.compile(), rng, 10.0))
    found = {(c.effect, c.actuator): c.parameters for c in answer.causes}
    assert set(found) == {("payload_mass", "body3"), ("spring_torque", "shoulder"), ("rotor_inertia", "elbow")}
    assert found["payload_mass", "body3"]["mass"].value == pytest.approx(0.3, rel=0.05)
    assert found["payload_mass", "body3"]["x"].value == pytest.approx(0.25, rel=0.05)
    assert found["spring_torque", "shoulder"]["stiffness"].value == pytest.approx(2.0, rel=0.05)
    assert found["rotor_inertia", "elbow"]["inertia"].value == pytest.approx(0.018, rel=0.1)


@pytest.mark.parametrize(("stiffness", "rotor"), [(2.5, 0.06), (2.4, 0.0)])
def test_a_payload_far_from_its_joint_is_no_heavier_link_beside_a_rotor(stiffness, rotor):
    """Two joints; the weight of the link is held up. About its joint such a payload needs a rotor below zero, and the
    first joint feels it as a rotor alone: a heavier link with a rotor, or a cable, stood in its place.
    """
    rng = np.random.default_rng([9415, 3])
    xml = drawn_xml(rng, servo=True, joints=2, methods=["implicitfast"])
    spec = mujoco.MjSpec.from_string(xml)
    spec.joints[1].stiffness[0] += stiffness
    spec.joints[0].armature += rotor
    ball = {"type": mujoco.mjtGeom.mjGEOM_SPHERE, "size": [0.01, 0, 0], "mass": 0.21}
    spec.bodies[-1].add_body(pos=[0.25, 0, 0]).add_geom(**ball, contype=0, conaffinity=0)
    answer = gap.diagnose(xml, log_of_servos(spec.compile(), rng, 10.0))
    named = {(c.effect, c.actuator): {c.effect, *c.rivals} for c in answer.causes}
    assert ("spring_torque", "shoulder") in named and (("rotor_inertia", "turn") in named) == bool(rotor)
    others = {k: x for k, x in named.items() if k not in {("spring_torque", "shoulder"), ("rotor_inertia", "turn")}}
    assert others and all("payload_mass" in x for x in others.values())
