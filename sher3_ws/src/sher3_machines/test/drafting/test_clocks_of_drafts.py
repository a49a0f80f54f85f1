"""What a draft takes for the clock of a record, and in which unit."""

import numpy as np
import pytest
from sher3_common import parse_yaml
from sher3_machines import MachineError
from sher3_machines.drafting.draft import draft
from written_tables import TIME, written


@pytest.mark.parametrize(("period", "unit"), [(1.001, "s"), (0.251, "s"), (5.0, "ms"), (12.5, "ms")])
def test_stamps_with_thousandths_are_seconds(tmp_path, period, unit):
    """A slow log in s is read to a ms; one in ms has no need of thousandths."""
    found = written(tmp_path, "time,pos", np.round(30.0 + period * np.arange(200), 3), np.sin(np.arange(200) / 9.0))
    assert f"unit: {unit}\n" in found.text


def test_a_row_number_for_a_time_is_said(tmp_path):
    found = written(tmp_path, "Time,angle", np.arange(len(TIME)), np.sin(TIME))
    assert any("grows by one a row" in guess and "--rate" in guess for guess in found.guesses)


def test_uneven_dates_of_today_and_columns_of_milliseconds_are_times(tmp_path):
    """Stamps of a socket, uneven and with pauses, under a name that says nothing."""
    steps = np.random.default_rng(0).exponential(0.005, len(TIME))
    found = written(tmp_path, "at,angle", 1.6336e9 + np.cumsum(steps), np.sin(TIME))
    assert any("'at', because it grows and reads as a date" in guess for guess in found.guesses)
    with pytest.raises(MachineError, match="no column looks like a time"):
        written(tmp_path, "at,angle", np.cumsum(steps), np.sin(TIME))
    found = written(tmp_path, "milliseconds,angle", 1e3 * np.cumsum(steps), np.sin(TIME))
    assert parse_yaml(found.text)["time"] == {"column": "milliseconds", "unit": "ms"}


def test_fractions_of_a_slow_clock_are_seconds_and_a_rate_is_no_clock(tmp_path):
    t = np.arange(200) * 0.2333
    np.savetxt(tmp_path / "a.csv", np.column_stack([t, np.sin(t)]), delimiter=",", header="t,angle", comments="")
    assert parse_yaml(draft(tmp_path / "a.csv").text)["time"]["unit"] == "s"
    np.savetxt(
        tmp_path / "b.csv", np.column_stack([t, np.sin(t)]), delimiter=",", header="baud_rate,speed", comments=""
    )
    with pytest.raises(MachineError, match="no column looks like a time"):
        draft(tmp_path / "b.csv")
