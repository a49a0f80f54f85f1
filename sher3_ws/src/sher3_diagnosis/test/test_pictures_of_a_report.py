"""The pictures of a report: what is drawn, where an axis is numbered, and that no library of figures is loaded."""

import re
import subprocess
import sys
from xml.etree import ElementTree

import numpy as np
import pytest
from sher3_diagnosis.report.drawing import MOST, Line, Panel, picture, stepped, ticks


def paths(*lines, **options):
    """Return the data of the paths of these lines, each in a colour of its own."""
    svg = picture([Panel("force [N]", 100, lines, **options)], "time [s]", "a picture")
    ElementTree.fromstring(svg)
    return {line.colour: re.search(f'd="([^"]*)" stroke="{line.colour}"', svg)[1] for line in lines}


def line(y, colour="red"):
    return Line(np.arange(len(y), dtype=float), np.array(y, dtype=float), colour, "real")


def test_a_line_begins_anew_where_a_sample_is_missing():
    found = paths(line([0.0, 1.0, np.nan, 1.0, 0.0]))["red"]
    assert found.count("M") == 2 and found.count("L") == 2


def test_a_long_line_keeps_its_spikes():
    y = np.zeros(20 * MOST)
    y[12345] = 1.0
    points = [float(p.split()[1]) for p in re.split("[ML]", paths(line(y))["red"])[1:]]
    assert len(points) <= MOST and min(points) < max(points)


def test_a_demand_is_drawn_in_steps():
    step = stepped(np.array([0.0, 1.0, 2.0]), np.array([5.0, 6.0, 7.0]), "red", "demand")
    assert list(zip(step.x, step.y, strict=True)) == [(0, 5), (0, 6), (1, 6), (1, 7), (2, 7)]


@pytest.mark.parametrize(
    "ends, said",
    [
        ((-4.2, 8.1), ["−4", "−2", "0", "2", "4", "6", "8"]),
        ((0.0, 0.6), ["0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6"]),
        ((1000.0, 1012.0), ["1000", "1002", "1004", "1006", "1008", "1010", "1012"]),
    ],
)
def test_an_axis_is_numbered_at_round_values(ends, said):
    assert [text for _, text in ticks(*ends)] == said


@pytest.mark.parametrize("y", [[2.0, 2.0], [np.nan, np.nan], []])
def test_a_line_without_extent_is_no_error(y):
    assert "nan" not in paths(line(y))["red"]


def test_a_report_loads_no_library_of_figures():
    code = "import sys; import sher3_diagnosis.report.page; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
