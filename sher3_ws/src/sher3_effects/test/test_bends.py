"""Laws with the shape of a real machine: a gap that is crossed by its own width, a limit that bends."""

from types import SimpleNamespace

import numpy as np
import pytest
from sher3_effects.limit.force_saturation import bent
from sher3_effects.lost_motion.joint_clearance import JointClearance
from sher3_effects.operators import frozen_integral

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
