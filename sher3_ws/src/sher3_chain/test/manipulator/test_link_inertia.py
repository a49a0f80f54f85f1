"""A rough model: mass, centre and inertia of several links are wrong at once, on drawn arms of MuJoCo."""

import mujoco
import numpy as np
import pytest
import sher3.gap as gap
from drawn_arms import drawn_xml, log_of_servos
from sher3_chain.manipulator.causes.links import OF_A_SUM
from sher3_chain.manipulator.rigid.physical import can_exist

SECONDS = 12.0
OF_A_JOINT = {"coulomb_friction", "viscous_friction"}
"""What the answer may name beside the links: laws that every joint has, small where the model states them."""


def wrong_links(rng):
    """The MJCF of a drawn arm, and the model of one whose links but the first are heavier and lie elsewhere."""
    xml = drawn_xml(rng, servo=True, joints=4).replace('gravcomp="1"', "")  # what holds a link would hold its error
    spec = mujoco.MjSpec.from_string(xml)
    for body in spec.bodies[2:]:
        geom = body.geoms[0]
        geom.mass *= rng.uniform(1.4, 2.0)
        geom.fromto = np.nan * geom.fromto
        geom.pos = [rng.uniform(0.0, 0.1), *rng.uniform(-0.05, 0.05, 2)]
        geom.size = [0.03, 0.1, 0]
    return xml, spec.compile()


def test_a_body_can_exist_where_its_inertia_about_its_centre_is_one():
    """A kilogram at 0.1 m along z has 0.01 kg m^2 about x and y; less is none, nor is a mass below zero."""
    point = np.array([1.0, 0.0, 0.0, 0.1, 0.011, 0.0, 0.011, 0.0, 0.0, 0.001])
    assert can_exist(point) and not can_exist(-point)
    assert not can_exist(point - np.array([0.0] * 4 + [0.002] + [0.0] * 5))


@pytest.mark.parametrize("seed", [3, 4, 5])
def test_several_wrong_links_are_links_and_neither_cables_nor_waves_nor_gains(seed):
    rng = np.random.default_rng(seed)
    xml, real = wrong_links(rng)
    answer = gap.diagnose(xml, log_of_servos(real, rng, SECONDS))
    links = {c.actuator for c in answer.causes if c.effect == "link_inertia"}
    assert links and {c.effect for c in answer.causes} <= {"link_inertia", *OF_A_JOINT}
    sums = {c.actuator for c in answer.causes for p in c.parameters.values() if p.means == OF_A_SUM}
    assert "body2" in sums and "change" not in {n for c in answer.causes for n, p in c.parameters.items() if p.means}
    if seed == 3:
        assert gap.diagnose(answer.corrected().text, log_of_servos(real, rng, SECONDS)).status == "no_gap"


@pytest.mark.parametrize("seed", [6, 7])
def test_a_weight_of_its_own_beside_wrong_links_is_a_constant_and_no_share_of_the_wrong_model(seed):
    """The zero of one effort is off besides: a share of a weight that the model has wrong would say nothing."""
    rng = np.random.default_rng(seed)
    xml, real = wrong_links(rng)
    log = log_of_servos(real, rng, SECONDS)
    answer = gap.diagnose(xml, {**log, "actuator_force": log["actuator_force"] + np.array([0.0, 2.0, 0.0, 0.0])})
    assert not any("relative" in c.parameters for c in answer.causes if c.effect in ("gravity_load", "torque_constant"))
