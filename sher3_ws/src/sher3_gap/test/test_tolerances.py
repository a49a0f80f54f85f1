"""Deviations of a robot as built: no alarm and no second cause within tolerance, a gap beyond it."""

import pytest
from sher3_description import Robot
from sher3_effects import plants
from sher3_gap.sher import diagnose_runs
from simulated import ROBOT, runs_of, signals


@pytest.fixture(scope="module")
def sensor_off():
    """Runs under known loads of a robot whose force sensor reads 0.05 % too much, and of one that reads 3 %."""
    effects = {share: [plants()["force_scale"]("force_sensor", relative=share)] for share in (5e-4, 0.03)}
    return {share: signals(runs_of(["loads", "postures"], e, repeats=3)) for share, e in effects.items()}


def test_a_sensor_matrix_within_its_data_sheet_is_no_alarm_and_is_told(sensor_off):
    verdict = diagnose_runs(sensor_off[5e-4], ROBOT).verdict
    assert verdict.status == "no_gap"
    told = {w.quantity: w for w in verdict.within_tolerance}
    assert told["force sensor matrix, fz"].value == pytest.approx(5e-4, abs=4e-4)
    assert all(abs(w.value) <= w.tolerance for w in told.values())


def test_one_beyond_it_is_a_cause(sensor_off):
    verdict = diagnose_runs(sensor_off[0.03], ROBOT).verdict
    assert [c.effect for c in verdict.causes] == ["force_scale"]
    assert verdict.causes[0].parameters["relative"].value == pytest.approx(0.03, rel=0.05)


def test_the_case_may_state_a_wider_table(sensor_off):
    wide = Robot.from_dict({**ROBOT.to_dict(), "tolerances": {"force_matrix": 0.1}})
    assert diagnose_runs(sensor_off[0.03], wide).verdict.status == "no_gap"
