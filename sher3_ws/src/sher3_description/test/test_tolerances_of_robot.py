"""Tolerances of a robot: SHER's by default, its own where its file states them, and no part of the model."""

import pytest
from sher3_description import Robot, load_robot
from sher3_description.invalid_robot import InvalidRobot

ROBOT = load_robot()


def test_a_file_that_states_none_has_those_of_the_contract():
    """Amendment 1.1, section 1."""
    assert (ROBOT.tolerances.mass, ROBOT.tolerances.gravity_load, ROBOT.tolerances.ratio) == (0.01, 0.005, 2e-5)
    assert (ROBOT.tolerances.link_length, ROBOT.tolerances.rail, ROBOT.tolerances.tool_mass) == (0.25e-6, 50e-6, 1e-4)
    assert "tolerances" not in ROBOT.to_yaml()


def test_a_file_may_state_its_own():
    data = {**ROBOT.to_dict(), "tolerances": {"mass": 0.03}}
    own = Robot.from_dict(data)
    assert (own.tolerances.mass, own.tolerances.viscous) == (0.03, 0.05)
    assert Robot.from_yaml(own.to_yaml()) == own
    assert own.digest() == ROBOT.digest()


@pytest.mark.parametrize(
    ("quantity", "value"),
    [("mass", 3.0), ("link_length", 0.25), ("ratio", 0.0), ("rail", float("nan")), ("colour", 1.0)],
)
def test_a_percentage_for_a_share_millimetres_for_metres_and_the_like_are_refused(quantity, value):
    with pytest.raises(InvalidRobot, match=quantity):
        Robot.from_dict({**ROBOT.to_dict(), "tolerances": {quantity: value}})
