"""The hazard table is whole: no row of the matrix without a hazard, no hazard that nothing verifies."""

from fnmatch import fnmatchcase
from pathlib import Path

import pytest
from sher3_bringup.settings.run_settings import RunSettings
from sher3_faults.fault_classes import fault_classes
from sher3_safety.hazards import FALSE_FORCE, HAZARDS, RUNAWAY, hazard_table, measured, rows_of
from sher3_safety.rows.processes import WALL
from sher3_safety.rows.stepped import ROWS

ROOT = Path(__file__).resolve().parents[4]
SETTINGS = RunSettings.model_validate({"regime": "free"})


@pytest.mark.parametrize("row", sorted({row.component for row in (*ROWS, *WALL)}))
def test_every_component_of_the_matrix_belongs_to_one_hazard(row):
    owners = [h.name for h in HAZARDS if any(fnmatchcase(row, pattern) for pattern in h.components)]
    assert len(owners) == 1, owners


@pytest.mark.parametrize("hazard", HAZARDS, ids=lambda hazard: hazard.name)
def test_every_hazard_is_verified_by_what_exists(hazard):
    assert rows_of(hazard) or hazard.tests
    assert all((ROOT / test).is_file() for test in hazard.tests)
    known = {item.fault for item in fault_classes(SETTINGS.control(), SETTINGS.drives())} | {RUNAWAY, FALSE_FORCE}
    assert set(hazard.faults) <= known


def test_the_residuals_are_those_of_the_budget():
    rows = {row["hazard"]: row for row in hazard_table(SETTINGS.budget())}
    axis = rows["an axis moves by itself"]["residual"]
    assert axis["near_tissue"] == pytest.approx(38, abs=1) and axis["free"] == pytest.approx(247, abs=1)
    assert all(row["residual"].get("free", 0.0) <= 250.0 for row in rows.values())
    over = {name for name, row in rows.items() if row["residual"].get("near_tissue", 0.0) > 40.0}
    assert over == {"the tip moves without a hand, or against it"}, "and its gap says so"
    assert "beyond the budget" in rows.pop(*over)["gap"]


@pytest.mark.parametrize("hazard", [h for h in HAZARDS if not h.faults], ids=lambda hazard: hazard.name)
def test_where_nothing_is_computed_the_gap_says_what_is_left(hazard):
    assert hazard.gap


def test_positions_that_are_wrong_alike_stand_among_what_is_left():
    (hazard,) = [h for h in HAZARDS if h.name == "goes elsewhere, since a position is wrong"]
    assert "both positions" in hazard.gap and "948 with the other sign" in hazard.gap


def test_frames_that_are_lost_in_a_recovery_belong_to_the_hazard_of_one():
    (hazard,) = [h for h in HAZARDS if h.name == "moves when a fault is cleared"]
    assert [row.loses for row in rows_of(hazard)] == ["delta_1.resets"]


def test_measured_travel_is_the_worst_of_the_cells_that_had_to_stop():
    cells = [
        {"component": "pedal", "effect": "stops", "state": "idle", "outcome": {"travel": 1e-6}},
        {"component": "pedal.travel", "effect": "stops", "state": "idle", "outcome": {"travel": 3e-6}},
        {"component": "pedal", "effect": "goes on", "state": "idle", "outcome": {"travel": 9e-6}},
        {"component": "clock", "effect": "stops", "state": "idle", "outcome": {"travel": 9e-6}},
    ]
    assert measured(HAZARDS[0], cells) == {"idle": 3e-6}
