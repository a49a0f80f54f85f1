"""Pairs and triples of faults, drawn: in stepped time none moves the tip beyond the budget of a runaway axis."""

from __future__ import annotations

import pytest
from sher3_control.motion.speed_cap import Regime
from sher3_description import load_robot
from sher3_safety.rows.row import IDLE
from sher3_safety.search.climb import search
from sher3_safety.search.draw import Draw, Fault, Shape
from sher3_safety.search.trial import try_all

pytestmark = pytest.mark.graph


def test_what_is_drawn_stays_within_the_budgets():
    result = search(50, seed=1)
    assert len(result.found) == 50 and not result.missed, result.as_text()
    assert sum(one.reason != "ENABLED" for one in result.found) > 25


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_two_hundred_draws_stay_within_the_budgets():
    result = search(200, seed=2)
    assert len(result.found) == 200 and not result.missed, result.as_text()


def test_a_trial_sees_the_travel_of_a_leg_that_runs_while_the_robot_brakes():
    """2 mm/s for 18 ms without a watch would be 36 um; a drive's EMCY stops the robot first."""
    runs = Fault("delta_1.power", Shape("power", "creep", "speed"), 1.0, 9)
    says = Fault("roll.demand", Shape("demand", "wrong", "code", float(0x8611)), 1.0, 0)
    (found,) = try_all([Draw((runs, says), IDLE, Regime.NEAR_TISSUE)], load_robot(), 1)
    assert found.reason == "DRIVE_EMERGENCY" and 10e-6 < found.travel < 40e-6
