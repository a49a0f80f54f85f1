"""What can be made of an answer: words, HTML, figure, report, rows, a corrected model."""

import sys
from types import ModuleType
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
import sher3.gap as gap


def test_it_prints_itself(answer):
    lines = str(answer).splitlines()
    assert lines[0].startswith("verdict  attributed: Coulomb friction on shoulder")
    assert repr(answer).startswith("Answer(attributed") and sum(x.startswith("guessed") for x in lines) == len(
        answer.guessed
    )


def test_a_notebook_shows_headline_cause_and_picture(answer):
    page = answer._repr_html_()
    assert "Coulomb friction on shoulder" in page and "<svg" in page and "guessed (" in page
    ElementTree.fromstring(page[: page.index("<figure>")] + "</div>")


def test_the_figure_has_a_picture_for_each_place(answer, log):
    assert len(answer.plot().axes) == len(answer.places) == 1
    seconds = np.concatenate([line.get_xdata() for line in answer.plot().axes[0].lines])
    assert 0.8 * np.ptp(log.time) < np.ptp(seconds) <= np.ptp(log.time)
    assert "shoulder" in answer.plot().axes[0].get_title(loc="left")


def test_the_report_is_written_where_asked(answer, tmp_path):
    page = answer.report(tmp_path / "r.html")
    assert page == (tmp_path / "r.html").read_text()
    assert "v.corrected(" in page and "sher3 gap export" not in page


def test_the_corrected_model_has_the_friction_of_both(answer, log, more, tmp_path):
    done = answer.corrected(tmp_path / "fixed.xml")
    before, after = (
        {j.get("name"): float(j.get("frictionloss")) for j in ElementTree.fromstring(text).iter("joint")}
        for text in (log.xml, (tmp_path / "fixed.xml").read_text())
    )
    assert after["turn"] == before["turn"]
    assert after["shoulder"] - before["shoulder"] == pytest.approx(more, rel=0.05)
    assert len(done.written) == 2 and "shoulder" in str(done)
    assert done.written[1] == "noise of the readings of turn, shoulder"
    assert [(x.reading, x.unit) for x in answer.noise] == [("position", "rad")] * 2
    assert [x.deviation for x in answer.noise] == pytest.approx([1e-5] * 2, rel=0.1)
    assert "turn position 9" in answer.report() or "turn position 10" in answer.report()
    again = gap.diagnose(str(tmp_path / "fixed.xml"), log.time, log.ctrl, log.qpos)
    assert again.places == [] or again.places[0].gap < 0.1 * answer.places[0].gap


def test_what_cannot_be_written_is_said(answer, tmp_path):
    with pytest.raises(gap.InputError, match="cannot be written"):
        answer.report(tmp_path / "nowhere" / "r.html")
    with pytest.raises(gap.InputError, match="written into the model that was given"):
        answer.corrected(to="urdf")
    with pytest.raises(gap.InputError, match="--to sdf --model"):
        answer.corrected(to="sdf")


def test_rows_and_frame(answer, monkeypatch):
    row = answer.to_rows()[0]
    assert (row["cause"], row["place"], row["unit"]) == ("coulomb_friction", "shoulder", "N*m")
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(gap.InputError, match="frames need pandas"):
        answer.to_frame()
    pandas = ModuleType("pandas")
    pandas.DataFrame = lambda rows, columns: (rows, columns)
    monkeypatch.setitem(sys.modules, "pandas", pandas)
    assert answer.to_frame() == (answer.to_rows(), list(row))


def test_paired_replays_show_what_the_causes_are_worth(answer, log):
    """Windows start at recorded states, so that the untuned model shows its missing friction and nothing else."""
    found = answer.simulate()
    turn, shoulder = found.joints["turn"], found.joints["shoulder"]
    assert f"shoulder: {1e3 * shoulder.before:.3g} mrad rms untuned" in str(found)
    assert shoulder.recorded.shape == shoulder.untuned.shape == shoulder.corrected.shape == shoulder.time.shape
    assert shoulder.after < 0.2 * shoulder.before and turn.after < 1.2 * turn.before
    at = np.searchsorted(log.time, shoulder.time[3, 5] - 1e-9)
    assert shoulder.recorded[3, 5] == pytest.approx(log.qpos[at, 1], abs=1e-9)
    assert len(found.plot().axes) == 2 and "shoulder: " in str(found)


def test_replays_need_a_text_of_the_model(log):
    answer = gap.diagnose(mujoco.MjModel.from_xml_string(log.xml), log.time, log.ctrl, log.qpos)
    with pytest.raises(gap.InputError, match="need the text of the model"):
        answer.simulate()


def test_axes_by_themselves_are_replayed_too():
    time = np.arange(0.0, 12.0, 0.002)
    place = 0.04 * np.sin(1.3 * time) + 0.015 * np.sin(4.1 * time)
    speed, signals = np.gradient(place, time), {"position": ("x", "m"), "effort": ("f", "N")}
    force = 3.0 * np.gradient(speed, time) + 2.0 * np.tanh(speed / 1e-3)
    axis = {"name": "slide", "motion": "linear", "mass": 3.0, "encoder_resolution": 1e-6}
    columns = {name: {"column": column, "unit": unit} for name, (column, unit) in signals.items()}
    axes = [{**axis, "signals": columns, "command_law": {"kind": "none"}}]
    described = {"kind": "axes", "name": "slide", "time": {"column": "t"}, "axes": axes}
    noisy = force + 0.02 * np.random.default_rng(1).normal(size=6000)
    (slide,) = gap.diagnose(described, {"t": time, "x": place, "f": noisy}).simulate().joints.values()
    assert slide.after < 0.2 * slide.before
