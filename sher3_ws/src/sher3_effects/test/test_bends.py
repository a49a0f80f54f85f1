"""Laws with the shape of a real machine: a gap that is crossed by its own width, a limit that bends."""

from types import SimpleNamespace

import numpy as np
import pytest
from sher3_effects.compliance.stiffening import softness
from sher3_effects.compliance.tool_bending import ToolBending
from sher3_effects.friction.stribeck_friction import StribeckFriction, StribeckOnAxis
from sher3_effects.inertia.gravity_load import GravityOnAxis
from sher3_effects.limit.force_saturation import bent
from sher3_effects.lost_motion.joint_clearance import JointClearance
from sher3_effects.operators import frozen_integral, play, released_play
from sher3_effects.periodic.cogging import Cogging, CoggingOnAxis
from sher3_effects.periodic.transmission_ripple import RippleOnAxis, TransmissionRipple
from sher3_effects.scale.encoder_scale import EncoderScale
from sher3_effects.scale.lead_error import LeadError, LeadErrorOnAxis
from sher3_effects.spring.spring_torque import SpringOnAxis
from sher3_effects.wrench.cable_drag import CableDrag

PAGE = JointClearance()
GAP = {"by_load": 0.0, "reach": 40e-6}


def test_a_limit_that_bends_is_straight_below_and_level_above():
    """Limit 10 N, knee 0.2: 8 N are 8 N; 10 N are 10 - 4 / 8 = 9.5 N; from 12 N on all are 10 N."""
    asked = np.array([-30.0, -8.0, 0.0, 8.0, 10.0, 12.0, 20.0])
    assert bent(asked, 10.0, 0.2) == pytest.approx([-10.0, -8.0, 0.0, 8.0, 9.5, 10.0, 10.0])
    assert bent(asked, 10.0, 0.0) == pytest.approx(np.clip(asked, -10.0, 10.0))


def test_the_integrator_of_a_limit_that_bends_stops_where_it_is_level():
    """Asked for 11 N: a hard limit of 10 N holds it for the whole period, one with a knee of 0.2 not at all."""
    n, axis = 3, (1.0, 0.0, 100.0, 10.0, 1e-3)
    force, law, step, travel = np.full(n, 9.8), np.full(n, 11.0), np.zeros(n), np.full(n, 2e-6)
    hard = frozen_integral(force, law, step, np.zeros(n), travel, axis, 0.0)
    soft = frozen_integral(force, law, step, np.zeros(n), travel, axis, 0.2)
    assert hard == pytest.approx([0.0, 2e-6, 4e-6])
    assert not soft.any()


def test_a_gap_is_crossed_by_as_much_travel_as_it_is_wide():
    """Forward by 100 um the slider is ahead; 20 um back it is in the middle of a gap of 40 um, 40 um back behind."""
    path = 1e-6 * np.concatenate([np.arange(0.0, 101.0), np.arange(99.0, 0.0, -1.0)])
    run = SimpleNamespace(smooth=path[:, None], period=1e-3, grid=np.arange(len(path)))
    view = SimpleNamespace(run=run, row=lambda site: 0, robot=None, path=SimpleNamespace(jacobian=np.ones((200, 6, 1))))
    view.at_tip = lambda columns: {"tip": columns}
    moved = PAGE.signature(view, "delta_1", GAP).columns["tip"][:, 0, 0]
    assert moved[[100, 120, 140, 180]] == pytest.approx([0.5, 0.0, -0.5, -0.5], abs=1e-9)
    assert PAGE.parameters(GAP, np.array([-39e-6])) == {"clearance": 40e-6}


@pytest.mark.parametrize(("jump", "possible"), [(-40e-6, True), (40e-6, False), (-90e-6, False)])
def test_what_has_play_lags_its_slider_by_no_more_than_the_gap(jump, possible):
    assert PAGE.admissible(GAP, np.array([jump])) == possible


PATH = 1e-6 * np.concatenate([np.arange(0.0, 51.0), np.arange(49.0, -1.0, -1.0)])
"""50 um forward and back, a micrometre a sample."""


def test_a_load_whose_friction_gives_way_goes_back_with_its_flank_first():
    """Gap 10 um, friction that gives way over 4: the load follows for 4 um, stays for 10, and is then pulled back."""
    still = np.zeros(len(PATH))
    lag = released_play(PATH, still, still, 4e-6, 10e-6, np.inf, 1e-3, -1.0)
    assert lag[[50, 54, 59, 64, 80]] == pytest.approx([-5e-6, -5e-6, 0.0, 5e-6, 5e-6], abs=1e-12)


def test_a_load_that_something_pulls_on_leaves_its_flank_where_both_are_in_balance():
    """Half the friction pulls it forward, against the flank that comes back: 2 um of the 4 are left to follow for."""
    still = np.zeros(len(PATH))
    lag = released_play(PATH, still, still + 2e-6, 4e-6, 10e-6, np.inf, 1e-3, -1.0)
    assert lag[[52, 57, 62]] == pytest.approx([-5e-6, 0.0, 5e-6], abs=1e-12)


def test_a_load_whose_friction_does_not_give_way_is_behind_a_plain_gap():
    """It begins 1.5 um ahead, is taken along from -5 um on, and behind by 5 um again ten micrometres after the turn."""
    still = np.zeros(len(PATH))
    plain = play(PATH, 10e-6, 0.3)
    assert plain[[0, 3, 6, 7, 50, 55, 60, 80]] == pytest.approx(
        1e-6 * np.array([1.5, -1.5, -4.5, -5.0, -5.0, 0.0, 5.0, 5.0]), abs=1e-12
    )
    assert released_play(PATH, still, still, 0.0, 10e-6, np.inf, 1e-3, 0.3) == pytest.approx(plain, abs=1e-15)


def test_a_compliance_that_stiffens_is_stated_at_one_newton():
    """Halved at 2 N: at 1 N it is that stated, at rest 1.5 times it, at 2 N three quarters of it."""
    soft = softness(np.array([[0.0, 0.0, 0.0], [0.0, 0.6, 0.8], [0.0, 2.0, 0.0]]), {"stiffens": 2.0})
    assert soft[:, 0, 0] == pytest.approx([1.5, 1.0, 0.75])
    assert softness(np.ones((2, 3)), {}) == pytest.approx(1.0)


def test_a_tool_that_stiffens_bends_less_than_twice_as_far_under_twice_the_load():
    """The tool points along z: 1 N across it bends it by c, 2 N by 3/2 c where it is halved at 2 N."""
    force = np.array([[1.0, 0.0, 5.0], [2.0, 0.0, 5.0]])
    path = SimpleNamespace(rotation=np.broadcast_to(np.eye(3), (2, 3, 3)), contact=force)
    view = SimpleNamespace(path=path, run=SimpleNamespace(tracker_position=force))
    (columns,) = ToolBending().signature(view, "tip", {"stiffens": 2.0}).columns.values()
    assert columns[:, 0, 0] == pytest.approx([1.0, 1.5])
    assert ToolBending().parameters({"stiffens": 2.0}, np.array([3e-5, 1e-3]))["stiffens"] == 2.0


def test_teeth_that_are_unlike_have_neighbouring_orders_and_harmonics():
    """Four teeth: orders 4, 3, 5, 2, 6, 1, 7, 8, 12; one tooth: 1, 2, 3, 4, once each. The amplitude is that of 4."""
    run = SimpleNamespace(smooth=np.array([[0.0], [1.0 / 16.0]]), to_grid=lambda x: x)
    view = SimpleNamespace(run=run, row=lambda site: 0, lead=lambda site: 1.0)
    (columns,) = Cogging().signature(view, "tilt", {"periods_per_rev": 4.0, "unlike": 1.0}).columns.values()
    turned = 2.0 * np.pi * np.array([4.0, 3.0, 5.0, 2.0, 6.0, 1.0, 7.0, 8.0, 12.0]) / 16.0
    assert columns[1, 0, ::2] == pytest.approx(np.sin(turned), abs=1e-12)
    (columns,) = Cogging().signature(view, "tilt", {"periods_per_rev": 1.0, "unlike": 1.0}).columns.values()
    assert columns.shape == (2, 1, 8)
    assert Cogging().parameters({"periods_per_rev": 4.0}, np.array([3.0, 4.0, 1.0, 1.0]))["amplitude"] == 5.0
    assert Cogging().bends([], "roll", {"periods_per_rev": 4.0})
    assert not CoggingOnAxis().bends([], "roll", {"periods_per_rev": 4.0})
    assert TransmissionRipple().bends([], "roll", {"periods_per_rev": 4.0, "side": 3.0, "third": 5.0})
    assert not RippleOnAxis().bends([], "roll", {"periods_per_rev": 4.0})


def test_a_spring_that_is_nearly_all_cube_is_relaxed_where_its_force_is_zero():
    """0.01 x + x^3 + 0.5 = 0 at x = -0.7895: a step of Newton's method from -50 goes astray there."""
    spring = SpringOnAxis().parameters({"middle": 0.0, "half": 1.0, "hardens": 1.0}, np.array([0.01, 0.5, 1.0]))
    assert 0.01 * spring["rest"] + spring["rest"] ** 3 == pytest.approx(-0.5)


@pytest.mark.parametrize(("falls", "hump"), [(0, np.exp(-4.0)), (1, np.exp(-2.0)), (2, 1.0 / (4.0 * np.e - 3.0))])
def test_every_hump_of_friction_is_one_at_rest_and_1_over_e_at_its_velocity(falls, hump):
    speed = np.array([0.0, 1e-3, -2e-3])
    run = SimpleNamespace(velocity=speed[:, None], to_grid=lambda x: x)
    view = SimpleNamespace(run=run, row=lambda site: 0, sliding=lambda axis, displacement: np.ones(3))
    shape = {"stribeck_velocity": 1e-3, "displacement": 1e-6, "falls": float(falls)}
    (columns,) = StribeckFriction().signature(view, "delta_1", shape).columns.values()
    assert columns[:, 0, 1] == pytest.approx([1.0, 1.0 / np.e, hump])
    assert {s["falls"] for s in StribeckFriction().bends([], "delta_1", shape)} == {1.0, 2.0}
    assert not StribeckOnAxis().bends([], "delta_1", shape)


def along(position: np.ndarray) -> SimpleNamespace:
    """Return a view of a run along one axis."""
    path = SimpleNamespace(jacobian=np.ones((len(position), 6, 1)))
    return SimpleNamespace(position=position[:, None], row=lambda site: 0, path=path, at_tip=lambda columns: {})


@pytest.mark.parametrize("page", [LeadError(), EncoderScale()])
def test_a_ratio_that_varies_is_stated_by_its_mean(page):
    """1e-3 over 10 mm, beside it 2 um a quarter of the way and as much back at three: still 1e-3 less the lean."""
    position = np.linspace(0.0, 0.01, 81)
    (shape,) = page.bends([along(position)], "delta_1", {})
    assert shape == {"middle": pytest.approx(0.005), "half": pytest.approx(0.005)}
    bump = 2e-6 * (np.interp(position, [0.00125, 0.0025, 0.00375], [0.0, 1.0, 0.0]))
    bump -= 2e-6 * np.interp(position, [0.00625, 0.0075, 0.00875], [0.0, 1.0, 0.0])
    columns = page.signature(along(position), "delta_1", shape).columns
    found = np.linalg.lstsq(next(iter(columns.values()))[:, 0], 1e-3 * position + bump, rcond=None)[0]
    assert found[[1, 2, 3, 5, 6]] == pytest.approx([0.0, 4e-4, 0.0, 0.0, -4e-4][:5], abs=1e-9)
    lean = -(4e-4 * 0.5 + 4e-4 * 0.5) / (2.0 * (0.25**2 + 0.5**2 + 0.75**2 + 1.0))
    assert page.parameters(shape, found)["relative"] == pytest.approx(1e-3 + lean)
    assert page.parameters({}, np.array([1e-3]))["relative"] == 1e-3


@pytest.mark.parametrize(("bend", "possible"), [(0.4e-3, True), (0.6e-3, False)])
def test_a_ratio_varies_by_less_than_it_is_off(bend, possible):
    assert LeadError().admissible({}, np.array([1e-3, 0.0, bend])) == possible
    assert EncoderScale().admissible({}, np.array([1e-3, 0.0, bend])) == possible


def test_the_ratio_of_any_other_machine_is_one_number():
    assert not LeadErrorOnAxis().bends([along(np.linspace(0.0, 1.0, 5))], "slide", {})


def test_a_cable_on_an_axis_pulls_the_harder_the_more_it_is_bent():
    """Pull 10 x + 5 x^3 N over +-1: mean stiffness 10 + 5 * 0.6 = 13 N per half travel. It may not soften anywhere."""
    x = np.linspace(-1.0, 1.0, 41)
    (shape,) = CableDrag().bends([along(2e-3 * x)], "delta_1", {"stroke": 0.0})
    (columns,) = CableDrag().signature(along(2e-3 * x), "delta_1", shape).columns.values()
    found = np.linalg.lstsq(columns[:, 0], 10.0 * x + 5.0 * x**3, rcond=None)[0]
    assert CableDrag().parameters(shape, found) == {
        "preload": pytest.approx(0.0, abs=1e-9),
        "stiffness": pytest.approx(13.0 / 2e-3),
    }
    assert CableDrag().admissible(shape, found)
    assert not CableDrag().admissible(shape, np.array([0.0, 6500.0, 0.0, -5.0]))
    assert not CableDrag().admissible(shape, np.array([0.0, 6500.0, -9.0, 1.0]))
    assert CableDrag().bends([along(x)], "force_sensor", {"stroke": 0.0}) == [{"stroke": 0.0, "lever": 1.0}]


def test_a_weight_and_a_force_that_change_places_become_one_of_them():
    """Over part of a turn sine, cosine and ones are nearly one: none of three has a size, two or one of them have."""
    view = SimpleNamespace(
        path=SimpleNamespace(gravity=np.zeros((3, 1))), axis=lambda site: SimpleNamespace(weighed=True, travel=0.7)
    )
    fewer = {
        n: [s["constant"] for s in GravityOnAxis().plainer([view], "lift", {"constant": n})] for n in (1.0, 2.0, 3.0)
    }
    assert fewer == {1.0: [], 2.0: [1.0], 3.0: [1.0, 2.0]}
