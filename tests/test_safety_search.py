"""Pairs and triples of faults, drawn: in stepped time none moves the tip beyond the budget of a runaway axis."""

from __future__ import annotations

from random import Random

import pytest
from sher3_control.motion.speed_cap import Regime
from sher3_description import load_robot
from sher3_safety.rows.row import IDLE
from sher3_safety.search.climb import search
from sher3_safety.search.draw import Draw, Fault, Shape, drawn
from sher3_safety.search.trial import try_all
from sher3_safety.search.words import read

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


def test_a_draw_comes_to_the_same_among_others_and_alone():
    """A leg goes one way, and all legs the other way 8 ms later: while all others kept their
    power for 0.1 s, 40.4 um near tissue.
    To the last digit: every draw begins in a fork of a robot that has come to its state.
    """
    line = "near_tissue, moving, delta_2.power creep speed 0.002 at 0; legs.power creep speed -0.002 at 4"
    draws = [read(line), *(drawn(Random(n), Regime.NEAR_TISSUE) for n in range(2)), read(line)]
    first, *others, again = try_all(draws, load_robot(), 1)
    assert first == again and [found.draw for found in others] == draws[1:3]
    assert try_all(draws[:1], load_robot(), 1) == [first]
    assert first.reason == "POSITION_LEFT" and 15e-6 < first.travel < 30e-6


def test_the_tip_adds_up_what_four_axes_are_off_and_so_does_the_watch():
    """Each of them judged alone made 40.6 um near tissue."""
    legs = "; ".join(f"delta_{n}.power creep speed {v} at 0" for n, v in ((1, -0.002), (2, 0.002), (3, 0.002)))
    line = f"near_tissue, idle, {legs}; tilt.power creep speed -0.0009 at 0"
    (found,) = try_all([read(line)], load_robot(), 1)
    assert found.reason == "POSITION_LEFT" and found.travel < 35e-6
