"""The verdict on a cell names everything that it misses, and the table shows the worst of it."""

from __future__ import annotations

from dataclasses import replace

import pytest
from sher3_safety.measurement.recording import Outcome
from sher3_safety.measurement.report import as_markdown, as_text, false_trips, misses
from sher3_safety.measurement.verdict import judge
from sher3_safety.rows.row import IDLE, LIMIT, MOVING, STATES, Row

ROW = Row("force_sensor", "off", reasons=("WRENCH_STALE",))
GOOD = Outcome("x", 5e-3, "WRENCH_STALE", 0.012, 0.040, 65e-6, 0.0, True, 0.0, 300e-6)


def test_a_good_cell_misses_nothing():
    assert judge(ROW, LIMIT, GOOD).holds
    assert judge(ROW, IDLE, replace(GOOD, speed=0.0, travel=0.0)).holds


def test_a_fault_may_be_noticed_before_the_pedal_is_released():
    assert judge(replace(ROW, release=True), LIMIT, replace(GOOD, operating="DISABLED")).holds


def test_a_robot_that_was_not_at_the_end_of_its_travel_misses():
    (state,) = [state for state in STATES if state.end]
    assert judge(ROW, state, replace(GOOD, to_end=0.5e-3)).holds
    (miss,) = judge(ROW, state, replace(GOOD, to_end=0.02)).misses
    assert miss == "2.0 % of its travel from its end before the fault (limit 0.1 %)"


@pytest.mark.parametrize(
    ("change", "part"),
    [
        ({"speed": 1e-3}, "moved at 1.00 mm/s before the fault instead of 5"),
        ({"travel": 251e-6}, "travelled 251 um (budget 250 um)"),
        ({"stop": None}, "did not stop"),
        ({"stop": 0.101}, "stood after 101 ms (limit 100)"),
        ({"detection": 0.051}, "noticed after 51 ms (limit 50)"),
        ({"reason": ""}, "nobody noticed"),
        ({"reason": "CLOCK"}, "reason CLOCK instead of WRENCH_STALE"),
        ({"alone": 6e-6}, "moved 6.0 um before the pedal was released"),
        ({"resumed": 0.0}, "did not move again"),
        ({"operating": "PAUSED"}, "was PAUSED when the fault set in instead of ENABLED"),
    ],
)
def test_each_shortfall_is_named(change, part):
    (miss,) = judge(ROW, LIMIT, replace(GOOD, **change)).misses
    assert part in miss


def test_near_tissue_the_budget_is_ten_times_tighter():
    outcome = replace(GOOD, speed=0.5e-3, travel=26e-6)
    assert judge(ROW, MOVING, outcome).misses == ("travelled 26 um (budget 25 um)",)


def test_what_must_go_on_may_neither_trip_nor_leave_its_way():
    row = Row("force_sensor", "duplicated", expects="goes on")
    going = replace(GOOD, reason="", detection=None, stop=None, travel=1e-3)
    assert judge(row, LIMIT, going).holds
    assert judge(row, LIMIT, replace(going, reason="CLOCK")).misses == ("tripped: CLOCK",)
    assert judge(row, LIMIT, replace(going, excess=260e-6)).misses == ("260 um off its way (budget 250 um)",)


def test_what_chance_decides_may_trip_but_then_stops_within_the_budget():
    row = Row("cpu", "slow", {"processes": 2.0}, expects="either")
    tripped = replace(GOOD, travel=1e-3, stop=0.4, detection=0.3, braking=100e-6)
    assert judge(row, LIMIT, tripped).holds
    (miss,) = judge(row, LIMIT, replace(tripped, braking=251e-6)).misses
    assert miss == "travelled 251 um after the report (budget 250 um)"


ENDED = Row("process.plant", "off", expects="ends", reasons=("DRIVE_SILENT",))
END = replace(GOOD, stop=None, travel=0.0, faulted=0.023, fault_reason="DRIVE_SILENT")


@pytest.mark.parametrize(
    ("change", "miss"),
    [
        ({"detection": None, "reason": ""}, "nobody noticed"),
        ({"detection": 0.051}, "noticed after 51 ms"),
        ({"faulted": None}, "no FAULT"),
        ({"faulted": 0.101}, "FAULT after 101 ms"),
        ({"fault_reason": "CPU_STARVED"}, "FAULT for CPU_STARVED instead of DRIVE_SILENT"),
    ],
)
def test_a_plant_that_ends_has_no_tip_but_must_be_reported_in_time(change, miss):
    assert judge(ENDED, LIMIT, END, recovered=False).holds
    assert judge(ENDED, LIMIT, replace(END, **change), recovered=False).misses == (miss,)


def test_a_cell_that_is_not_in_the_recording_misses():
    assert judge(ROW, LIMIT, None).misses == ("not in the recording",)


def test_the_table_shows_every_state_and_counts_what_misses():
    travels = {"idle": 0.0, "moving": 6.5e-6, "at limit": 300e-6, "at end": 1e-6}
    good = replace(GOOD, to_end=0.0)
    cells = [judge(ROW, state, replace(good, speed=state.speed, travel=travels[state.name])) for state in STATES]
    text = as_text(cells)
    assert "MISS 1 of 4" in text and "300.0" in text and "6.5" in text
    assert misses(cells) == ["force_sensor off, at limit: travelled 300 um (budget 250 um)"]
    line = "| force_sensor off | WRENCH_STALE | 12 | 40 | 0.0 | 6.5 | 300.0 | 1.0 |  | stops | MISS 1 of 4 |"
    assert line in as_markdown("title", cells)


def test_no_trip_still_has_a_bound():
    """Zero events in T hours: at most -ln 0.05 / T per hour with 95 % confidence."""
    rate = false_trips(0, 0.5)
    assert rate["per_hour"] == 0.0 and rate["upper_95"] == pytest.approx(5.99, abs=0.01)
    assert false_trips(3, 0.5)["upper_95"] == pytest.approx(15.51, abs=0.02)
