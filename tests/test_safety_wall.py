"""Processes killed in wall time while the robot moves at its speed limit: measured from the bag of each run."""

from __future__ import annotations

import pytest
from sher3_bringup.safety_wall import run_case
from sher3_safety.matrix import LIMIT
from sher3_safety.processes import WALL
from sources import ROOT

pytestmark = pytest.mark.graph
FOLDER = ROOT / "bags" / "tests" / "safety"


def at_speed(verdict):
    """Skip, visibly, where the strict time limits have stopped the robot before anything was broken."""
    if verdict.outcome is None or verdict.outcome.speed < 0.8 * LIMIT.speed:
        pytest.skip("the machine is too busy for the strict time limits: the robot had stopped before")


@pytest.mark.parametrize("row", [row for row in WALL if row.quick], ids=lambda row: row.component)
def test_a_killed_process_stops_the_robot_within_the_budget(row, domain):
    verdict = run_case(row, LIMIT, FOLDER, domain=domain)
    at_speed(verdict)
    assert verdict.holds, verdict.misses


@pytest.mark.slow
@pytest.mark.parametrize("row", [row for row in WALL if not row.quick], ids=lambda row: f"{row.component}-{row.fault}")
def test_every_process_killed_or_held(row, domain):
    verdict = run_case(row, LIMIT, FOLDER, domain=domain)
    at_speed(verdict)
    assert verdict.holds, verdict.misses
