"""The report and the commands: complete, self-contained, honest about what has not run."""

import json
from pathlib import Path

import pytest
from invoking import invoke as run
from sher3_common import FileError
from sher3_paper.cli import app
from sher3_paper.comparison import Comparison, compare, within
from sher3_paper.errors import BadData
from sher3_paper.report import html, markdown
from sher3_paper.sections import SECTIONS, build
from sher3_paper.sections.benchtop import benchtop
from sher3_paper.tables import inconsistencies

FAST = ["geometry", "torsion", "design", "grasp"]


def test_verdicts() -> None:
    assert compare("x", "1", 1.0, 1.04, 0.05, "c").verdict == "reproduced"
    assert compare("x", "1", 1.0, 1.06, 0.05, "c").verdict == "differs"
    assert within("x", "%", 15.0, -14.0, "c").verdict == "within band"
    assert within("x", "%", 15.0, 15.1, "c").verdict == "differs"
    assert Comparison("x", "1", 2.0, None, "not run", "c").difference is None


def test_report_is_one_file_with_every_part() -> None:
    sections = build(FAST)
    page = html(sections)
    assert page.count("data:image/png;base64,") == sum(len(section.figures) for section in sections) == 4
    assert "http" not in page.split("<body>")[1]
    for section in sections:
        assert section.title in page
    for item in inconsistencies():
        assert f"<td>{item['id']}</td>" in page


def test_every_comparison_names_its_command() -> None:
    for section in build([*FAST, "benchtop"]):
        for line in section.comparisons:
            assert line.command.startswith("sher3 ")
            assert (line.computed is None) == (line.verdict == "not run")


def test_markdown_has_every_line() -> None:
    sections = build(["geometry", "design"])
    pages = markdown(sections)
    assert [*pages] == ["geometry", "design", "inconsistencies"]
    for section in sections:
        assert all(f"| {line.quantity} |" in pages[section.name] for line in section.comparisons)
    assert all(f"| {item['id']} |" in pages["inconsistencies"] for item in inconsistencies())


def test_benchtop_says_that_it_has_not_run(tmp_path: Path) -> None:
    lines = benchtop().comparisons
    assert {line.verdict for line in lines} == {"not run"}
    assert len(lines) == 14 + 6 + 15
    results = tmp_path / "benchtop.json"
    results.write_text(json.dumps({"accuracy/x_motion/x/mean": 18.5}))
    filled = {line.quantity: line for line in benchtop(results).comparisons}
    assert filled["accuracy/x_motion/x/mean"].difference == pytest.approx(1.5)
    assert filled["accuracy/y_motion/y/mean"].verdict == "not run"


def test_bad_benchtop_results(tmp_path: Path) -> None:
    bad = tmp_path / "bad.json"
    for text in ("not json", "[1]", '{"a": "b"}'):
        bad.write_text(text)
        with pytest.raises(FileError):
            benchtop(bad)
    with pytest.raises(FileError, match="no such file"):
        benchtop(tmp_path / "none.json")


def test_unknown_part() -> None:
    with pytest.raises(BadData, match="part of the report"):
        build(["everything"])
    assert set(FAST) <= set(SECTIONS)


def test_paper_command(tmp_path: Path) -> None:
    result = run(app, ["paper", "--only", "geometry", "--only", "design", "--out", str(tmp_path), "--json"])
    assert result.exit_code == 0
    parts = json.loads(result.stdout)
    assert [part["name"] for part in parts] == ["geometry", "design"]
    gci = next(line for line in parts[1]["comparisons"] if line["quantity"] == "GCI, circumradius")
    assert gci["verdict"] == "reproduced"
    assert (tmp_path / "report.html").stat().st_size > 20_000


def test_design_command(tmp_path: Path) -> None:
    result = run(app, ["design", "--json", "--figure", str(tmp_path / "trends.png")])
    summary = json.loads(result.stdout)
    assert summary["designs"] == 960
    assert summary["chosen"]["meets"] == {"reach": True, "clearance": False, "stroke": False, "swing": False}
    assert (tmp_path / "trends.png").read_bytes().startswith(b"\x89PNG")
    shown = run(app, ["design", "--constraints", "reach", "--reading", "midplane"]).stdout
    assert "rank 131 of 960" in shown


def test_fine_search_command() -> None:
    result = json.loads(run(app, ["design", "--fine", "500", "--poses", "12", "--json"]).stdout)
    assert result["designs"] >= 500


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["design", "--reading", "diameter"], "reading"),
        (["design", "--constraints", "none"], "constraints"),
        (["design", "--torque", "0"], "torque"),
        (["design", "--fine", "100000000"], "number of designs"),
        (["paper", "--only", "nothing"], "part of the report"),
        (["paper", "--only", "benchtop", "--benchtop", "/nonexistent.json"], "no such file"),
    ],
)
def test_errors_of_the_commands(arguments: list[str], says: str) -> None:
    result = run(app, arguments)
    assert result.exit_code == 2
    assert says in result.stderr
