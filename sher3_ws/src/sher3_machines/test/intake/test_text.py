"""Text as spreadsheets and loggers write it."""

import numpy as np
import pytest
from sher3_machines import MachineError
from sher3_machines.intake.columns import pick
from sher3_machines.intake.fields import Column
from sher3_machines.intake.tables import read_tables


def tables(tmp_path, text):
    (tmp_path / "a.csv").write_text(text, encoding="utf-8")
    return read_tables(tmp_path / "a.csv")


def test_a_decimal_comma(tmp_path):
    found = tables(tmp_path, "t;q\n0,00;1,5\n0,01;-2,5e-1\n")
    assert found["t"].tolist() == [0.0, 0.01] and found["q"].tolist() == [1.5, -0.25]


def test_points_stay_points_where_semicolons_part(tmp_path):
    assert tables(tmp_path, "t;q\n0.0;1.5\n0.1;2.5\n")["q"].tolist() == [1.5, 2.5]


def test_iso_times_are_seconds(tmp_path):
    found = tables(
        tmp_path, "time,q\n2024-03-01T12:00:00.250Z,1\n2024-03-01T13:00:00.260+01:00,2\n2024-03-01 12:00:00.27,3\n"
    )
    assert np.diff(found["time"]) == pytest.approx([0.01, 0.01], abs=1e-6)
    assert found["time"][0] == pytest.approx(1709294400.25)


def test_units_in_the_header(tmp_path):
    found = tables(tmp_path, "t [s],q [mm],i (mA),w [furlong]\n0,1,5,1\n1,2,6,2\n")
    assert pick(Column(column="q"), found, "a").tolist() == pytest.approx([1e-3, 2e-3])
    assert pick(Column(column="i", factor=2.0), found, "a").tolist() == pytest.approx([0.010, 0.012])
    assert pick(Column(column="q [mm]", unit="mm"), found, "a").tolist() == pytest.approx([1e-3, 2e-3])
    with pytest.raises(MachineError, match=r"another unit; value mm; limit deg"):
        pick(Column(column="q", unit="deg"), found, "a")
    with pytest.raises(MachineError, match=r"not stated; value furlong"):
        pick(Column(column="w"), found, "a")


def test_counts_need_their_size():
    with pytest.raises(ValueError, match="m or rad per count"):
        Column(column="q", unit="count")
    column = Column(column="q", unit="count", factor=1e-3)
    assert pick(column, {"q": np.array([0.0, 1500.0])}, "a").tolist() == [0.0, 1.5]


def test_preambles_headers_in_comments_and_blank_lines(tmp_path):
    found = tables(tmp_path, "# made by a logger\n# t q\n\n0.0 1.5\n0.1 2.5\n")
    assert found["q"].tolist() == [1.5, 2.5]


def test_a_table_that_is_none_says_why(tmp_path):
    with pytest.raises(MachineError, match="no rows"):
        tables(tmp_path, "")


def test_a_logger_may_write_the_stamps_of_each_channel(tmp_path):
    """Stamps that are written again are one column; another one of the same name is told apart."""
    found = tables(tmp_path, "t,q,t,q\n0.0,1.5,0.0,7.0\n0.1,2.5,0.1,8.0\n0.2,3.5,0.2,9.0\n")
    assert list(found) == ["t", "q", "q.2"]
    assert found["q"].tolist() == [1.5, 2.5, 3.5] and found["q.2"].tolist() == [7.0, 8.0, 9.0]


def test_a_missing_column_names_its_neighbours():
    with pytest.raises(MachineError, match=r"no column 'positon'.*position.*name it as the data do"):
        pick(Column(column="positon", unit="m"), {"position": np.zeros(3), "time": np.zeros(3)}, "a")


HEAD = "Prüfprotokoll;;\nDatum;14.03.2024;\nZeit [ms];Sollposition [Schritte];Glasmaßstab [µm]\n"


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252", "utf-16"])
def test_a_table_of_a_german_spreadsheet(tmp_path, encoding):
    """Titles are filled up with empty cells to the width of the table."""
    (tmp_path / "a.csv").write_bytes((HEAD + "0,0;0;1,5\n4,0;10;2,5\n8,0;20;3,5\n").encode(encoding))
    found = read_tables(tmp_path / "a.csv")
    assert found["Glasmaßstab [µm]"].tolist() == [1.5, 2.5, 3.5] and found["Zeit [ms]"].tolist() == [0.0, 4.0, 8.0]


def test_an_index_without_a_name_is_a_column_and_no_title(tmp_path):
    assert tables(tmp_path, ",t,q\n0,0.0,1.5\n1,0.1,2.5\n")["q"].tolist() == [1.5, 2.5]


def test_bytes_that_are_no_text_are_refused(tmp_path):
    (tmp_path / "a.csv").write_bytes(b"\x00\x01\x81\x8d" * 40)
    with pytest.raises(MachineError, match=r"is no text; limit UTF-8, UTF-16, Windows-1252; save the table"):
        read_tables(tmp_path / "a.csv")


def test_columns_that_are_added():
    """A piston of 1 m^2 with 2 bar on one side and 1 bar on half of it on the other."""
    other = {"column": "pb", "unit": "bar", "factor": -0.5}
    force = Column.model_validate({"column": "pa", "unit": "bar", "factor": 1.0e-3, "plus": [other]})
    data = {"pa": np.full(3, 2000.0), "pb": np.full(3, 1.0), "short": np.zeros(2)}
    assert pick(force, data, "a") == pytest.approx(np.full(3, 150e3))
    other["column"] = "short"
    with pytest.raises(MachineError, match=r"a: short has other rows; value \(2,\); limit \(3,\); add columns"):
        pick(Column.model_validate({"column": "pa", "unit": "bar", "factor": 1e-3, "plus": [other]}), data, "a")
    with pytest.raises(ValueError, match="a pressure needs its `factor`"):
        Column(column="pa", unit="bar")


@pytest.mark.parametrize("signals", [3, 8, 15])
def test_a_row_for_each_signal_is_turned(tmp_path, signals):
    """`numpy.savetxt` of a list of signals writes a few lines that are very long; a short table stays as it is."""
    rows = np.arange(signals)[:, None] * 1000.0 + np.arange(400)
    found = tables(tmp_path, "\n".join(",".join(f"{x:g}" for x in row) for row in rows))
    assert list(found) == [f"c{i}" for i in range(signals)] and (found["c2"] == rows[2]).all()
    assert len(tables(tmp_path, "\n".join("1,2,3,4" for _ in range(3)))) == 4


def test_decimal_commas_between_tabs_part_nothing(tmp_path):
    """Each line has as many commas, as the lines of a table that a spreadsheet took for one column of text have."""
    found = tables(tmp_path, "".join(f"{0.01 * k:.2f}\t{k / 7:.6f}\n".replace(".", ",") for k in range(40)))
    assert found["c0"][3] == pytest.approx(0.03) and found["c1"][3] == pytest.approx(0.428571)


def test_a_unit_behind_a_stroke_is_one(tmp_path):
    """A quantity over its unit (ISO 80000-1); strokes that part tables stay."""
    assert list(tables(tmp_path, "Time/s,Angle/rad,AngVel/rad/s\n0,1,2\n1,2,3\n")) == [
        "Time [s]",
        "Angle [rad]",
        "AngVel [rad/s]",
    ]
    assert list(tables(tmp_path, "temp/min,temp/max\n0,1\n1,2\n")) == ["temp/min", "temp/max"]


@pytest.mark.parametrize("word", ["OK", "baseline", "2024-13-77"])
@pytest.mark.parametrize("place", [0, 1, 2])
def test_words_beside_the_numbers_of_the_first_row_make_no_header(tmp_path, word, place):
    rows = [[f"{0.01 * i:.2f}", f"{i * i}"] for i in range(40)]
    (tmp_path / "a.csv").write_text("\n".join(",".join([*r[:place], word, *r[place:]]) for r in rows))
    found = read_tables(tmp_path / "a.csv")
    assert len(found) == 2 and all(len(x) == 40 for x in found.values())


@pytest.mark.parametrize("sign", [";", ""])
def test_a_matrix_as_matlab_writes_it_is_a_table(tmp_path, sign):
    """Titles of several words stand over columns that blanks part, as the controllers of teaching rigs export them."""
    rows = [f"{i}  {0.009 * i:.3f}  {-i}  0.50" for i in range(6)]
    text = "Sample  Time   Encoder 1 Pos   Control Effort\n\n[" + f"{sign}\n".join(rows) + "]\n"
    found = tables(tmp_path, text)
    assert list(found) == ["Sample", "Time", "Encoder 1 Pos", "Control Effort"]
    assert found["Encoder 1 Pos"].tolist() == [0.0, -1.0, -2.0, -3.0, -4.0, -5.0]
    assert tables(tmp_path, "a = [0 1.5; 1 2.5; 2 3.5];")["c1"].tolist() == [1.5, 2.5, 3.5]


def test_a_script_with_a_matrix_under_a_comment_is_a_table(tmp_path):
    """Wide blanks part titles of several words; what follows the matrix is the script's."""
    rows = ";\n".join(f"{i}   {0.009 * i:.3f}   {i * i}   {-i}" for i in range(40))
    text = f"% Sample   Time     Encoder 1 Pos   Control Effort\n\ndata =[ {rows}];\n\nt = data(:,2); %read\nplot(t)\n"
    found = tables(tmp_path, text)
    assert list(found) == ["Sample", "Time", "Encoder 1 Pos", "Control Effort"]
    assert found["Time"][-1] == 0.351 and all(len(x) == 40 for x in found.values())
    (tmp_path / "log.m").write_text(text, encoding="utf-8")
    assert list(read_tables(tmp_path / "log.m")) == list(found)


def test_curves_that_a_plotter_saved_are_channels_with_stamps(tmp_path):
    """`NAME_x` grows and `NAME_y` is what was read; channels end one by one."""
    rows = [f"{0.01 * i:g},{i},{0.01 * i + 0.003:g},{-i}," for i in range(30)] + ["0.3,30, , ,"]
    found = tables(tmp_path, "\n".join(["/js/q[3]_x,/js/q[3]_y,/js/effort[3]_x,/js/effort[3]_y", *rows]) + "\n")
    assert list(found) == [f"/js/{n}[3]/{what}" for n in ("q", "effort") for what in ("stamp", "value")]
    assert len(found["/js/q[3]/value"]) == 31 and len(found["/js/effort[3]/stamp"]) == 30
    left = tables(tmp_path, "t,ball_x,ball_y\n" + "\n".join(f"{i},{i},{-i}" for i in range(30)) + "\n")
    assert list(left) == ["t", "ball_x", "ball_y"]


def test_settings_stand_above_and_below_a_header_with_stamps_of_windows(tmp_path):
    """An export of a Beckhoff scope: the header is the line of words that is as wide as the table."""
    above = (
        "Name;of a test;\nStarttime;132900081483250000;Tuesday, February 22, 2022;13:55:48\n\nTrigger;Count;Release;\n"
    )
    below = "".join(
        f"{name};{value};{value}\n" for name, value in zip("ABCDEFG", ["x", 8, 8, "True", 0, 852, 1], strict=True)
    )
    rows = "".join(f"{132900081483250000 + 100_000 * k};{k};{0.5 * k}\n" for k in range(60))
    found = tables(tmp_path, f"{above}\nName;Act (Counter);Act (Resolver)\n{below}{rows}EOF\n")
    assert list(found) == ["Name", "Act (Counter)", "Act (Resolver)"]
    assert found["Name"][:3] == pytest.approx([1645534548.325, 1645534548.335, 1645534548.345], abs=1e-5)
    assert found["Act (Resolver)"][:60].tolist() == [0.5 * k for k in range(60)]


def test_remarks_between_the_rows_and_another_table_below_are_no_rows(tmp_path):
    rows = [f"{0.1 * i:.1f},{np.sin(0.1 * i):.3f}\n" for i in range(60)]
    said = [row + ("current_position: -78.3\n" * 40 if i == 30 else '""\n') for i, row in enumerate(rows)]
    found = tables(tmp_path, "Time (s),angle\n" + "".join(said))
    assert len(found["Time (s)"]) == 60 and not np.isnan(found["angle"]).any()
    wide = "".join(f"{0.1 * i:.1f} {i % 7} {i % 5}\n" for i in range(60))
    found = tables(tmp_path, wide + "".join(f"{0.1 * i:.1f} {i % 3}\n" for i in range(50)))
    assert len(found["c0"]) == 60 and found["c2"].max() == 4.0


def test_tabs_beside_commas_part_nothing(tmp_path):
    rows = "".join(f"{i},\t{0.5 * i}\t,{-i}\t,0.00\n" for i in range(30))
    assert tables(tmp_path, rows)["c1"][-1] == 14.5


def test_titles_that_are_fewer_than_the_columns_are_none(tmp_path):
    """Which of them is missing, nobody can tell: all behind it would be read as their neighbours."""
    rows = "".join(f"{0.01 * i:.2f},{i % 7},{i % 5},{i % 3}\n" for i in range(30))
    assert list(tables(tmp_path, "time,q,u\n" + rows)) == ["c0", "c1", "c2", "c3"]


@pytest.mark.parametrize("mark", [", ", " "])
def test_a_log_of_python_has_its_stamp_in_one_column(tmp_path, mark):
    rows = "".join(f"2021-12-27 18:06:{i:02d},250 {0.5 * i}{mark}-0.05\n" for i in range(30))
    found = tables(tmp_path, rows)
    assert list(found) == ["c0", "c1", "c2"] and found["c1"][4] == 2.0
    assert np.diff(found["c0"]) == pytest.approx(1.0)


def test_times_of_day_are_stamps(tmp_path):
    (tmp_path / "a.csv").write_text("Time;Distance\n9:59:59.900;15.86\n10:00:00,025;15.84\n10:00:00.100;15.79\n")
    found = read_tables(tmp_path / "a.csv")
    assert np.allclose(np.diff(found["Time"]), [0.125, 0.075]) and found["Time"][0] == 35999.9
