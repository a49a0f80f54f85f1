"""A rough model: mass, centre and inertia of several links are wrong at once, on drawn arms of MuJoCo."""

import mujoco
import numpy as np
import pytest
import sher3.gap as gap
from drawn_arms import drawn_xml, log_of_servos
from lifts import friction, machine, motion, needed, run_of
from sher3_chain.manipulator.causes.links import OF_A_SUM, wrong_links
from sher3_chain.manipulator.causes.payload import beside, payloads
from sher3_chain.manipulator.causes.plan import laws_beside_links
from sher3_chain.manipulator.rigid.physical import can_exist
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.thresholds import JACKKNIFE

SECONDS = 12.0
OF_A_JOINT = {"coulomb_friction", "viscous_friction"}
"""What the answer may name beside the links: laws that every joint has, small where the model states them."""


def rough_model(rng):
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
    xml, real = rough_model(rng)
    answer = gap.diagnose(xml, log_of_servos(real, rng, SECONDS))
    links = {c.actuator for c in answer.causes if c.effect == "link_inertia"}
    assert links and {c.effect for c in answer.causes} <= {"link_inertia", *OF_A_JOINT}
    sums = {c.actuator for c in answer.causes for p in c.parameters.values() if p.means == OF_A_SUM}
    assert sums and "change" not in {n for c in answer.causes for n, p in c.parameters.items() if p.means}
    if seed == 3:
        assert gap.diagnose(answer.corrected().text, log_of_servos(real, rng, SECONDS)).status == "no_gap"


@pytest.mark.parametrize("seed", [6, 7])
def test_a_weight_of_its_own_beside_wrong_links_is_a_constant_and_no_share_of_the_wrong_model(seed):
    """The zero of one effort is off besides: a share of a weight that the model has wrong would say nothing."""
    rng = np.random.default_rng(seed)
    xml, real = rough_model(rng)
    log = log_of_servos(real, rng, SECONDS)
    answer = gap.diagnose(xml, {**log, "actuator_force": log["actuator_force"] + np.array([0.0, 2.0, 0.0, 0.0])})
    assert not any("relative" in c.parameters for c in answer.causes if c.effect in ("gravity_load", "torque_constant"))


@pytest.fixture
def loaded(tmp_path):
    """Evidence of a pendulum that carries half a kilogram, and the candidates for it."""
    q, v, a = motion()
    arm = machine(tmp_path / "lift.urdf")
    run = run_of(q, needed(q, v, a, 0.5, 0.05, -0.3) + friction(v, (8.0, 0.5)))
    evidence = arm.gather([run])[0]
    return evidence, Candidates(evidence, arm.effects(evidence))


def test_links_are_not_looked_for_where_a_load_does_as_well(loaded):
    """A body on a link has four numbers, a link that is wrong ten: both leave the floor."""
    evidence, candidates = loaded
    page = next(e for e in candidates.effects if e.free() is not None)
    plain = beside(evidence, candidates)
    laws = [(t.effect, t.site, t.shape) for t in plain]
    links = wrong_links(evidence, page, laws)
    errors = [abs(shape[n]) / shape[n + page.ERROR] for _, _, shape in links for n in page.numbers(shape)]
    assert errors and min(errors) > JACKKNIFE  # what may be zero is no number of a link
    assert not wrong_links(evidence, page, laws, [x.fit for x in payloads(evidence, candidates, plain)])


def test_links_of_which_every_number_may_be_zero_are_none(loaded, monkeypatch):
    evidence, candidates = loaded
    page = next(e for e in candidates.effects if e.free() is not None)
    laws = [(t.effect, t.site, t.shape) for t in beside(evidence, candidates)]
    monkeypatch.setattr("sher3_chain.manipulator.causes.links.JACKKNIFE", np.inf)
    assert wrong_links(evidence, page, laws) == []


def test_a_link_that_no_judged_joint_carries_is_left_out(tmp_path):
    """The lift has no effort: its carriage, which the swing does not feel, has no number that could be told."""
    q, v, a = motion()
    still = {"lift": {"signals": {"position": {"column": "q", "unit": "1"}}}}
    arm = machine(tmp_path / "lift.urdf", joint=still)
    run = run_of(q, needed(q, v, a, 0.5, 0.05, -0.3))
    del run.signals["lift"]["effort"]
    evidence = arm.gather([run])[0]
    page = next(e for e in arm.effects(evidence) if e.free() is not None)
    assert {site for _, site, _ in wrong_links(evidence, page, [])} == {"pendulum"}


def test_neither_a_spring_nor_a_gain_is_looked_for_beside_links_that_are_found(loaded):
    kept = laws_beside_links(loaded[1].effects)
    left_out = {e.id for e in loaded[1].effects} - {e.id for e in kept}
    assert {"spring_torque", "cable_torque", "torque_constant"} == left_out
