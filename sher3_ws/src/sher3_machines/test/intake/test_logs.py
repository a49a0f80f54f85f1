"""Logs as their loggers write them: signs behind the last cell, settings above, a reading a line, other endings."""

import numpy as np
import pytest
from sher3_machines import MachineError
from sher3_machines.intake.tables import read_tables

ROWS = 30


def read(tmp_path, text, name="a.csv"):
    (tmp_path / name).write_text(text, encoding="utf-8")
    return read_tables(tmp_path / name)


def test_a_sign_behind_the_last_cell_parts_nothing(tmp_path):
    found = read(tmp_path, "t,q\n" + "".join(f"{i}.0,{2 * i}.5;\n" for i in range(ROWS)))
    assert list(found) == ["t", "q"]
    assert found["q"][-1] == 58.5


def test_units_stand_below_the_names_of_a_preamble(tmp_path):
    head = "%Operator: none\n%Date:,29/04/2021\n\n%timestep (8Hz),voltage,position\n%[#],[V],[turns]\n"
    found = read(tmp_path, head + "".join(f"{i}.0,0.5,{i}.0;\n" for i in range(ROWS)))
    assert list(found) == ["timestep (8Hz)", "voltage [V]", "position [turns]"]


def test_settings_that_are_wider_than_the_table_are_no_header(tmp_path):
    head = "Graph,2,,,,,,,\n-1,321,MX(2.0),Position,#00ff00,0,,-10,8\nTime[ms],Tick,Position,Goal,,,,,\n"
    found = read(tmp_path, head + "".join(f"{i * 32},{i},{i + 1},0,,,,,\n" for i in range(ROWS)))
    assert list(found) == ["Time[ms]", "Tick", "Position", "Goal"]


@pytest.mark.parametrize("mark", [" ", ",", "\t"])
def test_a_reading_a_line_becomes_a_table_of_each_channel(tmp_path, mark):
    lines = []
    for i in range(ROWS):
        stamp = f"2020-12-08{' ' if mark == ' ' else 'T'}16:17:{i:02d}.500000"
        lines += [f"IOC:Enc-PosAct{mark}{stamp}{mark}{0.25 * i}"] + [f"IOC:Axis{mark}{stamp}{mark}{i}"] * (i % 2)
    found = read(tmp_path, "\n".join(lines), "a.log")
    assert sorted(found) == [f"IOC:{name}/{what}" for name in ("Axis", "Enc-PosAct") for what in ("stamp", "value")]
    np.testing.assert_allclose(np.diff(found["IOC:Enc-PosAct/stamp"]), 1.0)
    np.testing.assert_allclose(found["IOC:Axis/value"], np.arange(1, ROWS, 2))


def test_text_of_an_unknown_ending_is_read_where_it_is_a_table(tmp_path):
    assert list(read(tmp_path, "".join(f"{i}.0\t{i}.5\n" for i in range(ROWS)), "run.t")) == ["c0", "c1"]
    for text in ("no table at all\n", "1.0 2.0\n"):
        with pytest.raises(MachineError, match="format is not read"):
            read(tmp_path, text, "notes.md")
