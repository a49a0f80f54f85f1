"""Names that files bring hold a quote, a tag and a script: pages show them as text, and a browser runs nothing."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import sher3.gap as gap
import yaml
from browser import CHROMIUM, browse
from invoking import invoke
from sher3_bags import Run, stream
from sher3_bags.figures.analysis import analyse
from sher3_bags.figures.report import Block
from sher3_common.samples import JointSample, TextSample
from sher3_description import load_robot
from sher3_diagnosis.report.drawing import Line, Panel, picture
from sher3_gap.report.drawing import robot_drawing
from sher3_gap_cli.app import app
from sher3_view import film_of, write_page
from sher3_view.figures import figures_section
from sher3_view.ghost import ghost_of
from sher3_view.live.plot import plot_svg
from sher3_view.live.snapshot import Snapshot

RUNS = "document.title=1337"
EVIL = f"""x" onload="{RUNS}" '><script>{RUNS}</script><img src=q onerror={RUNS}><svg onload='{RUNS}'>$\\x$ {{{{7}}}}"""
FILE = EVIL.replace("/", "")
"""The same as the name of a file, which holds no slash."""
TIME = np.arange(0.0, 5.0, 0.002)
POSITION = 0.05 * np.sin(np.pi * TIME) + 0.02 * np.sin(2.6 * np.pi * TIME)


def effort() -> np.ndarray:
    """Of a mass with friction, which is a cause to show."""
    speed = np.gradient(POSITION, TIME)
    noise = np.random.default_rng(1).normal(0, 0.5, len(TIME))
    return 95.0 * np.gradient(speed, TIME) + 200.0 * speed + 20.0 * np.sign(speed) + noise


def description() -> dict:
    signals = {"position": {"column": "position", "unit": "m"}, "effort": {"column": "force", "unit": "N"}}
    axis = {"name": EVIL, "motion": "linear", "signals": signals, "command_law": {"kind": "force"}}
    axis |= {"mass": "unknown", "encoder_resolution": 2.1e-06}
    return {"kind": "axes", "name": EVIL, "time": {"column": "time", "unit": "s"}, "axes": [axis]}


def called(*words: str) -> None:
    result = invoke(app, list(words))
    assert result.exit_code == 0, result.output


def reports(folder: Path) -> None:
    """Two records of such a machine, diagnosed: the report, and the notebook's answer."""
    columns = np.c_[TIME, POSITION, effort()]
    names = [folder / f"{k}{FILE}.csv" for k in "ab"]
    for name in names:
        np.savetxt(name, columns, delimiter=",", header="time,position,force", comments="", fmt="%.9g")
    text = yaml.safe_dump(description())
    (folder / "machine.yaml").write_text(text)
    case = folder / FILE
    called("import", *map(str, names), str(folder / "machine.yaml"), "--out", str(case))
    called("diagnose", str(case), "--out", str(folder / "report"))
    (folder / "report" / "report.html").rename(folder / "report.html")
    answer = gap.diagnose(description(), {"time": TIME, "position": POSITION, "force": columns[:, 2]})
    (folder / "answer.html").write_text(answer._repr_html_())


def film(folder: Path) -> None:
    """A recording with its figures, states and ghost."""
    stamp = 1_000_000_000 + np.arange(0, 400_000_001, 2_000_000)
    status = json.dumps({"state": EVIL, "reason": EVIL})
    run = Run(
        {
            "measured_js": stream("measured_js", stamp, position=np.zeros((len(stamp), 5))),
            "supervisor/status": stream("supervisor/status", stamp[:1], data=[status]),
            "admittance/status": stream("admittance/status", stamp[:1], data=[json.dumps({"text": EVIL})]),
        }
    )
    run.path = folder / FILE
    shown = film_of(run)
    shown = replace(shown, limits=[(EVIL, *row[1:]) for row in shown.limits])
    section = figures_section(run, analyse(run), [Block(EVIL, (EVIL,), ((EVIL,),))])
    write_page(shown, folder / "film.html", [ghost_of(shown, run, 2.0)], section)


def drawings(folder: Path) -> None:
    """Single pictures, as pages take them in."""
    svg = picture([Panel(EVIL, 40, [Line(TIME[:3], POSITION[:3], "#000", EVIL)], band=(1.0, EVIL))], EVIL, EVIL)
    parts = [svg, robot_drawing(load_robot(), [EVIL]), plot_svg(TIME[:3], POSITION[:3], EVIL, EVIL, "#000")]
    (folder / "drawings.html").write_text("<!doctype html><meta charset=utf-8>" + "".join(parts))


def test_a_picture_has_no_attribute_of_a_names_making(tmp_path):
    drawings(tmp_path)
    _, *pictures = (tmp_path / "drawings.html").read_text().split("<svg ")
    for text in pictures:
        root = ElementTree.fromstring("<svg " + text.split("</svg>")[0] + "</svg>")
        assert not [part for part in root.iter() if "onload" in part.attrib or part.tag.endswith("script")]


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here: nobody has looked at the pages")
def test_no_name_runs_as_a_script_on_any_page(tmp_path):
    for make in (reports, film, drawings):
        make(tmp_path)
    control = tmp_path / "control.html"
    control.write_text(f"<title>no</title><svg role='img' aria-label=\"{EVIL}\"></svg>")
    pages = sorted(tmp_path.glob("*.html"))
    assert [page.stem for page in pages] == ["answer", "control", "drawings", "film", "report"]
    with browse(control.as_uri(), tmp_path / "profile") as browser:
        assert browser.wait(lambda: browser.evaluate("document.title") == "1337"), "unescaped it would run"
        for page in pages:
            if page == control:
                continue
            browser.call("Page.navigate", url=page.as_uri())
            assert browser.wait(lambda: browser.evaluate("document.readyState") == "complete")
            assert browser.evaluate("document.title") != "1337", page.name
            handlers = "document.querySelectorAll('[onload], [onerror], img[src=q]').length"
            assert browser.evaluate(handlers) == 0, page.name
            assert RUNS in browser.evaluate("document.documentElement.textContent"), page.name


def test_what_a_topic_says_is_plain_text_on_the_live_panel():
    """Its Markdown would take a tag for HTML, and a brace for a program."""
    fault = {"code": EVIL, "source": EVIL}
    statuses = {"supervisor/status": {"state": EVIL, "reason": EVIL, "first_fault": fault, "refused": {"text": EVIL}}}
    samples = {topic: TextSample(json.dumps(data)) for topic, data in statuses.items()}
    text = Snapshot({"measured_js": JointSample(0, (0.0,) * 5), **samples}).text(load_robot(), 0)
    assert text.count("onload") >= 3
    for mark in "<>{}`\"'$":
        assert all(text[k - 1] == "\\" for k, letter in enumerate(text) if letter == mark), mark
