"""`sher3 safety --wall`: processes killed and held while the robot moves, measured from their bags."""

from __future__ import annotations

import json

import pytest
from sher3_bringup.safety_wall import run_wall
from sher3_safety.processes import WALL, WALL_STATES
from sher3_safety.verdict import UNMEASURED
from sources import ROOT

pytestmark = pytest.mark.graph
FOLDER = ROOT / "bags" / "tests" / "safety"
QUICK = [row for row in WALL if row.quick]


@pytest.fixture(scope="module")
def cells(run_sher3):
    result = run_sher3("safety", "--wall", "--quick", "--json", "--out", str(FOLDER / "wall_quick"), timeout=240.0)
    assert result.returncode in (0, 1), result.stderr
    return {cell["name"]: cell for cell in json.loads(result.stdout)["cells"]}


@pytest.mark.parametrize("row", QUICK, ids=lambda row: row.name)
def test_a_killed_or_held_process_stops_the_robot_within_the_budget(cells, row):
    hold(cells[row.name])


@pytest.mark.slow
def test_every_process_killed_or_held_in_every_state(run_sher3):
    result = run_sher3("safety", "--wall", "--json", "--out", str(FOLDER / "wall"), timeout=1000.0)
    cells = json.loads(result.stdout)["cells"]
    assert [(c["name"], c["state"]) for c in cells] == [(row.name, s.name) for row in WALL for s in WALL_STATES]
    for cell in cells:
        if not unmeasured(cell):
            hold(cell)
    if kept := [f"{cell['name']}, {cell['state']}" for cell in cells if unmeasured(cell)]:
        pytest.skip(f"all others hold; {UNMEASURED}: {'; '.join(kept)}")


def test_a_run_that_takes_too_long_says_what_it_has_not_begun(tmp_path):
    result = run_wall(tmp_path, quick=True, limit=0.0)
    assert len(result.verdicts) == len(QUICK) and result.missed
    assert all(verdict.misses == ("not begun: the run takes longer than 0 s",) for verdict in result.verdicts)


def hold(cell):
    """Demand that nothing is missed; skip, visibly, where the strict limits stopped the robot before the fault."""
    if unmeasured(cell):
        pytest.skip(f"{cell['name']}, {cell['state']}: {cell['misses'][0]}")
    assert not cell["misses"], f"{cell['name']}, {cell['state']}"


def unmeasured(cell):
    """Whether the fault did not find the robot in the state it is meant for."""
    return any(miss.startswith(UNMEASURED) for miss in cell["misses"])
