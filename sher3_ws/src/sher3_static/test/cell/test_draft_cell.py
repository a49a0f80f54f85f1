"""Drafts of load cells: tables of weights and readings as people write them."""

import re

import numpy as np
import pytest
from sher3_common import parse_yaml
from sher3_diagnosis import diagnose
from sher3_machines import MachineError, import_case, open_case
from sher3_machines.drafting.drafts import draft_of
from sher3_machines.intake.kind import Draft

LEVELS = np.tile([0.0, 10.0, 20.0, 30.0, 40.0, 30.0, 20.0, 10.0], 6)
COUNTS = 5800.0 + 1000.0 * LEVELS + 90.0 * np.random.default_rng(1).normal(size=len(LEVELS))


def drafted(tmp_path, header, *columns):
    np.savetxt(tmp_path / "a.csv", np.column_stack(columns), delimiter=",", header=header, comments="", fmt="%.6g")
    return draft_of(tmp_path / "a.csv")


def bias(tmp_path, found):
    (tmp_path / "a.yaml").write_text(found.text, encoding="utf-8")
    import_case([tmp_path / "a.csv"], tmp_path / "a.yaml", tmp_path / "case")
    causes = diagnose(*open_case(tmp_path / "case")).verdict.causes
    return {c.effect: next(iter(c.parameters.values())).value for c in causes}


@pytest.mark.parametrize(
    ("header", "newton"),
    [
        ("force [lbf],cell 1", 4.4482216),
        ("weight_g,counts", 9.80665e-3),
        ("mass (kg),reading", 9.80665),
        ("applied_N,signal_mV", 1.0),
        ("load [mN],counts", 1e-3),
        ("weight (lb),counts", 4.4482216),
        ("Gewicht [kg],Messwert", 9.80665),
    ],
)
def test_a_table_of_weights_and_readings_is_a_load_cell(tmp_path, header, newton):
    """A zero of 5.8 of the unit, whatever that is, in newtons."""
    found = drafted(tmp_path, header, LEVELS, COUNTS)
    assert "kind: load_cell" in found.text
    assert bias(tmp_path, found) == {"force_bias": pytest.approx(5.8 * newton, rel=0.02)}


@pytest.mark.parametrize(
    ("unit", "newton"), [("g", 9.80665e-3), ("gf", 9.80665e-3), ("kg", 9.80665), ("kgf", 9.80665), ("lb", 4.4482216)]
)
def test_a_unit_of_weights_may_be_stated_where_no_header_has_it(tmp_path, unit, newton):
    """`unit: g` in place of the drafted N, and the sensitivity of the data sheet for it."""
    found = drafted(tmp_path, "Weight,Reading", LEVELS, COUNTS)
    text = re.sub("factor: .*", f"factor: {newton / 1000.0:.8g}", found.text.replace("unit: N\n", f"unit: {unit}\n"))
    assert bias(tmp_path, Draft(text, [])) == {"force_bias": pytest.approx(5.8 * newton, rel=0.02)}


def test_a_row_without_a_reading_is_no_reading(tmp_path):
    counts = COUNTS.copy()
    counts[[3, 17]] = np.nan
    found = drafted(tmp_path, "weight_g,counts", LEVELS, counts)
    assert bias(tmp_path, found) == {"force_bias": pytest.approx(5.8 * 9.80665e-3, rel=0.02)}
    assert "a: 2 of 48 rows lack a number and are no readings" in open_case(tmp_path / "case")[1][0].notes


def test_a_reading_that_lacks_often_is_refused(tmp_path):
    found = drafted(tmp_path, "weight_g,counts", LEVELS, COUNTS)
    np.savetxt(
        tmp_path / "a.csv",
        np.column_stack([LEVELS, np.where(np.arange(48) % 2, COUNTS, np.nan)]),
        delimiter=",",
        header="weight_g,counts",
        comments="",
    )
    with pytest.raises(MachineError, match="is not finite at sample 0; value 24 of 48 samples"):
        bias(tmp_path, found)


@pytest.mark.parametrize("noise", [0.0, 500.0, 2000.0])
def test_single_readings_may_scatter(tmp_path, noise):
    found = drafted(tmp_path, "weight_g,counts", LEVELS, COUNTS + noise * np.random.default_rng(3).normal(size=48))
    assert "kind: load_cell" in found.text


def test_a_bridge_that_counts_backwards_is_a_cell_too(tmp_path):
    found = drafted(tmp_path, "reading,weight [kg]", -COUNTS, LEVELS)
    assert "column: weight [kg]" in found.text and "factor: -0.0" in found.text


@pytest.mark.parametrize(
    ("header", "columns"),
    [
        ("force_N,position_mm", (LEVELS, COUNTS)),
        ("t,force_N,reading", (np.arange(48.0), LEVELS, COUNTS)),
        ("weight_kg,reading", (LEVELS, np.random.default_rng(2).normal(size=48))),
    ],
)
def test_a_spring_a_record_in_time_and_what_does_not_follow_are_no_cell(tmp_path, header, columns):
    try:
        assert "load_cell" not in drafted(tmp_path, header, *columns).text
    except MachineError as error:
        assert "looks like a" in str(error)


def test_a_force_that_a_spring_gave_over_its_travel_is_no_known_load(tmp_path):
    """What a sensor read beside it follows it exactly, and was computed from it."""
    travel = 20.0 - 20.0 * np.cos(np.linspace(0.0, 6.0, 60))
    force = -0.3 * np.tanh(travel / 20.0)
    table = np.column_stack([travel, force, 0.03 * force])
    np.savetxt(
        tmp_path / "a.csv", table, delimiter=",", header="Servo Displacement (deg),Force (N),Tz (Nm)", comments=""
    )
    with pytest.raises(MachineError, match="force over speed or travel"):
        draft_of(tmp_path / "a.csv")


@pytest.mark.parametrize("read", ["bridge", "mean_volts_per_volt"])
def test_of_loads_that_were_meant_and_laid_on_the_one_is_taken_that_the_reading_follows(tmp_path, read):
    """And a reading that is called otherwise than loads are, whatever follows them besides."""
    laid = LEVELS + 0.4 * np.random.default_rng(2).normal(size=len(LEVELS))
    header = f"no,nominal_torque,mean_torque,{read}"
    found = drafted(tmp_path, header, np.arange(len(LEVELS)), LEVELS, laid, 1e-6 * (30.0 + laid))
    assert "loads are 'mean_torque', in N*m" in found.text and f"the reading is '{read}'" in found.text


def test_a_reading_in_a_unit_of_a_load_keeps_it(tmp_path):
    """What two cells read of one torque: the slope between them is the error that is looked for, and no factor."""
    load = np.concatenate([np.linspace(-20.0, 20.0, 15), np.linspace(20.0, -20.0, 15)])
    rows = np.column_stack([load, 0.9 * load + np.random.default_rng(0).normal(0.0, 0.02, 30)])
    np.savetxt(tmp_path / "a.csv", rows, delimiter=",", header="reference torque [Nm],cell [Nm]", comments="")
    reading = parse_yaml(draft_of(tmp_path / "a.csv").text)["reading"]
    assert reading == {"column": "cell [Nm]", "unit": "N*m"}


@pytest.mark.parametrize("header", ["applied_N,reading_N", "known_N,read_N", "reference_N,cell_N", "load_N,output_N"])
def test_a_letter_behind_what_was_laid_on_or_read_is_newton(tmp_path, header):
    """And the zero of what counts in newtons, 5.8 N, is found without a factor; a number of the row is no reading."""
    found = drafted(tmp_path, f"cycle_N,{header}", np.arange(len(LEVELS)) // 8, LEVELS, 1e-3 * COUNTS)
    assert parse_yaml(found.text)["reading"] == {"column": header.split(",")[1], "unit": "N"}
    assert bias(tmp_path, found) == {"force_bias": pytest.approx(5.8, rel=0.02)}
