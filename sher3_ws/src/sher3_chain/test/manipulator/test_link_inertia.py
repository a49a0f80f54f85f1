"""A rough model: mass, centre and inertia of several links are wrong at once, on drawn arms of MuJoCo."""

import mujoco
import numpy as np
import pytest
import sher3.gap as gap
from drawn_arms import drawn_xml, log_of_servos

SECONDS = 12.0
OF_A_JOINT = {"coulomb_friction", "viscous_friction"}
"""What the answer may name beside the links: laws that every joint has, small where the model states them."""


@pytest.mark.parametrize("seed", [3, 4, 5])
def test_several_wrong_links_are_links_and_neither_cables_nor_waves_nor_gains(seed):
    rng = np.random.default_rng(seed)
    xml = drawn_xml(rng, servo=True, joints=4).replace('gravcomp="1"', "")  # what holds a link would hold its error
    spec = mujoco.MjSpec.from_string(xml)
    for body in spec.bodies[2:]:
        geom = body.geoms[0]
        geom.mass *= rng.uniform(1.4, 2.0)
        geom.fromto = np.nan * geom.fromto
        geom.pos = [rng.uniform(0.0, 0.1), *rng.uniform(-0.05, 0.05, 2)]
        geom.size = [0.03, 0.1, 0]
    real = spec.compile()
    answer = gap.diagnose(xml, log_of_servos(real, rng, SECONDS))
    links = {c.actuator for c in answer.causes if c.effect == "link_inertia"}
    assert links and {c.effect for c in answer.causes} <= {"link_inertia", *OF_A_JOINT}
