"""The compact matrix of faults in stepped time: every verdict is read from the bags it leaves in bags/tests/safety."""

from __future__ import annotations

import json
import shutil

import pytest
from sher3_bags.reading import read_run
from sher3_bringup.settings.run_settings import RunSettings
from sher3_control.motion.speed_cap import Regime
from sher3_description import load_robot
from sher3_safety.measurement.report import misses
from sher3_safety.measurement.verdict import judge
from sher3_safety.rows.row import AIMING, IDLE, LIMIT, MOVING, PAUSED, STATES, Row
from sher3_safety.runs.matrix import run_matrix
from sher3_safety.runs.stepped import run_cells
from sources import ROOT

pytestmark = pytest.mark.graph
FOLDER = ROOT / "bags" / "tests" / "safety"


@pytest.fixture(scope="module")
def compact():
    for old in FOLDER.glob("compact*"):
        shutil.rmtree(old)
    return run_matrix(FOLDER, quick=True)


def test_every_cell_of_the_compact_matrix_holds(compact):
    """It stops in time, within the budget, for the stated reason, and moves again only after release-then-press."""
    assert len(compact.verdicts) >= 36
    assert not misses(compact.verdicts)


def test_every_state_and_every_kind_of_component_is_in_it(compact):
    components = {verdict.row.component.partition(".")[0] for verdict in compact.verdicts}
    assert components >= {"force_sensor", "pedal", "bus", "delta_1", "process", "clock"}
    assert {verdict.state for verdict in compact.verdicts} >= {*STATES, PAUSED, AIMING}


def test_the_robot_was_at_speed_before_and_moved_again_after(compact):
    """Without this a robot that never moves would pass. The first tick of a creep counts: 2 mm/s for 2 of 40 ms."""
    for verdict in compact.verdicts:
        assert verdict.outcome.speed == pytest.approx(verdict.state.speed, rel=0.2, abs=1.2e-4)
        if verdict.row.expects == "stops" and not verdict.row.final:
            assert verdict.outcome.resumed > 20e-6


def test_the_report_has_every_row(compact, tmp_path):
    compact.write(tmp_path)
    text = (tmp_path / "report.md").read_text()
    assert all(f"| {verdict.row.name} |" in text for verdict in compact.verdicts)
    cells = json.loads((tmp_path / "report.json").read_text())["cells"]
    assert len(cells) == len(compact.verdicts)


def test_the_bag_says_what_was_injected(compact):
    bags = [path for path in FOLDER.glob("compact*") if path.is_dir()]
    labels = {json.loads(text).get("label") for bag in bags for text in read_run(bag, check=False)["mock/fault"].data}
    assert {v.row.label(v.state) for v in compact.verdicts} <= labels


def test_a_fault_that_nobody_sees_misses():
    """The verdict must be able to fail: a force scaled by 1.2 is no fault anybody could notice."""
    row = Row("force_sensor", "wrong", {"scale": 1.2})
    found = run_cells("unseen", [(row, LIMIT)], load_robot(), FOLDER)
    verdict = judge(row, LIMIT, found[row.label(LIMIT)])
    assert "nobody noticed" in verdict.misses and "did not stop" in verdict.misses


def test_a_fault_is_the_same_again_for_its_seed():
    row = Row("force_sensor", "intermittent", {"probability": 0.8}, expects="either")
    runs = [run_cells("seeded", [(row, IDLE), (row, LIMIT)], load_robot(), FOLDER, seed=5) for _ in range(2)]
    assert runs[0] == runs[1]


@pytest.mark.slow
@pytest.mark.timeout(1200)
def test_the_whole_matrix_holds():
    assert not misses(run_matrix(FOLDER / "whole").verdicts)


CLASSES = {
    "force_sensor off": "force sensor silent, dead",
    "force_sensor stuck": "force sensor frozen",
    "bus off": "CAN bus off or cut",
    "process.admittance stuck": "admittance node dead",
    "process.supervisor stuck": "supervisor dead",
}
"""Rows of the matrix and the class of the travel budget that each belongs to."""


@pytest.mark.parametrize(("state", "regime"), [(MOVING, Regime.NEAR_TISSUE), (LIMIT, Regime.FREE)])
def test_what_was_measured_is_within_what_the_budget_predicts(compact, state, regime):
    """Two independent ways to the same number: settings alone, and the recorded tip. Neither is far above the other."""
    predicted = {row.fault: row.travel for row in RunSettings().budget().of(regime)}
    measured = {v.row.name: v.outcome.travel for v in compact.verdicts if v.state is state}
    for name, fault in CLASSES.items():
        assert 0.2 * predicted[fault] < measured[name] <= predicted[fault], name
