"""The generated URDF is well formed and carries the robot's numbers (its kinematics is tested with Pinocchio)."""

import math
from xml.etree import ElementTree

import pytest
from sher3_description import load_robot
from sher3_description.urdf import tilt_angle_limits, urdf


def test_urdf_is_a_tree_with_the_robots_numbers() -> None:
    root = ElementTree.fromstring(urdf(load_robot().replace({"arm.d2": 0.2125})))
    links = {link.get("name") for link in root.iter("link")}
    children = [joint.find("child").get("link") for joint in root.iter("joint")]
    assert len(children) == len(set(children)) == len(links) - 1
    assert set(children) == links - {"b"}
    joints = {joint.get("name"): joint for joint in root.iter("joint")}
    assert joints["tilt_angle"].find("origin").get("xyz") == "0.2125 0.0 0.032"
    assert float(joints["roll"].find("limit").get("upper")) == load_robot().actuators[3].limits.upper


def test_tilt_limits_are_about_sixty_degrees() -> None:
    lower, upper = tilt_angle_limits(load_robot())
    assert math.degrees(lower) == pytest.approx(-60, abs=0.5)
    assert math.degrees(upper) == pytest.approx(60, abs=0.5)
