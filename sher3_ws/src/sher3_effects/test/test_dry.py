"""A dry friction at rest: any force up to its level, which the page tells sample by sample."""

from types import SimpleNamespace

import numpy as np
import pytest
from sher3_effects.friction.coulomb_friction import CoulombFriction
from sher3_effects.friction.stribeck_friction import StribeckFriction
from sher3_effects.view import NominalAxis

MOVES = np.array([0.0, 9e-6, 11e-6, 5e-3])
"""Speeds, m/s; with counts of 1 um an axis rests below 10 um/s."""


def view(seen=1e-6):
    run = SimpleNamespace(ticks=4, to_grid=lambda x: x, velocity=MOVES[:, None])
    axis = NominalAxis(1.0, 0.0, 2e-3, 0.01, seen=seen)
    back = np.full(4, -0.3)
    facts = {"run": run, "velocity": MOVES[:, None], "holds_at_rest": True}
    return SimpleNamespace(**facts, row=lambda site: 0, axis=lambda site: axis, sliding=lambda i, d: back)


def test_at_rest_it_holds_any_force_up_to_its_level_whatever_it_slid_before():
    held = CoulombFriction().held(view(), "tilt", {"displacement": 5e-6}, np.array([2.0]))
    assert held == pytest.approx([2.0, 2.0, 0.0, 0.0])


def test_one_that_falls_with_speed_holds_its_static_level():
    """1 N in motion and 0.5 N more at rest, gone at 9 um/s where the hump is 1 um/s wide."""
    shape = {"stribeck_velocity": 1e-6, "displacement": 5e-6}
    held = StribeckFriction().held(view(), "tilt", shape, np.array([1.0, 0.5]))
    assert held == pytest.approx([1.5, 1.0, 0.0, 0.0])


def test_nothing_is_said_where_nobody_states_a_count():
    assert CoulombFriction().held(view(seen=0.0), "tilt", {"displacement": 5e-6}, np.array([2.0])) is None
