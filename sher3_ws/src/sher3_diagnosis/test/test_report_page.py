"""The page of a machine that says nothing particular: the sections it has, and numbers worked out by hand."""

import re
from dataclasses import replace

import numpy as np
import pytest
from sher3_diagnosis.flow import diagnose
from sher3_diagnosis.report.causes import cause_cards, separates
from sher3_diagnosis.report.chain import AT_FLOOR, GAP, chain
from sher3_diagnosis.report.page import render
from sher3_diagnosis.report.traces import scale_of
from sher3_diagnosis.reporter import Isolability, Reporter, counted
from sher3_diagnosis.verdict import Cause, Closure, Interval, Verdict, Where
from toy import DIRECTION, OFFSET, SPEED, Column, Toy, case


@pytest.fixture(scope="module")
def rubbing():
    return diagnose(Toy(), case(3.0))


@pytest.fixture(scope="module")
def healthy():
    return diagnose(Toy(), case(0.0))


def test_the_page_stands_alone_and_answers_first(rubbing):
    page = render(rubbing, "toy")
    assert "<h1>Direction on axis, 3" in page and "of the gap" in page
    assert not re.findall(r'(?:src|href)="(?!#)[^"]+"', page) and "<script src" not in page
    assert page.count('class="zoom"') == page.count("<nav>") > 0  # every curve can be zoomed
    for heading in ("Where the gap is", "What causes it", "How far the gap shrinks", "Real, nominal, corrected"):
        assert f"<h2>{heading}</h2>" in page
    assert "What these topics can tell apart" not in page  # the machine does not say


def test_closures_are_bars_in_percent_of_the_gap(rubbing):
    """Less than none of the gap is a bar of no length, and its interval begins there."""
    cause = Cause(
        effect="backlash", family="lost_motion", stage="transmission", actuator="tilt", parameters={},
        closure=Interval(value=0.95, low=-0.1, high=1.0),
    )  # fmt: skip
    where = Where(stage="transmission", actuator="tilt", gap=2.0, floor=1.0, unit="m", regime="", confidence=1.0)
    answer = Verdict(status="attributed", where=[where], causes=[cause], closure=Closure(tip=Interval(value=-0.2)))
    page = render(replace(rubbing, verdict=answer), "toy")
    one, tip = re.findall(r'<div class="bar shut.*?"><span>(.*?)</span><div>(.*?)</div><b>(.*?)</b></div>', page)
    assert one[::2] == ("Backlash, tilt", "95 %") and "width: 95.0%" in one[1] and "left: 0.0%; right: 0.0%" in one[1]
    assert tip[::2] == ("all causes, at the tip", "-20 %") and "width: 0.0%" in tip[1] and "<i" not in tip[1]


def test_a_gap_without_a_cause_has_no_corrected_curve():
    """A wave of two periods that no effect of the toy has."""
    runs = [replace(r, values=r.values + 5.0 * np.sign(np.sin(np.arange(len(r.values))))) for r in case(0.0)]
    page = render(diagnose(Toy(), runs), "toy")
    assert "<h2>Real and nominal</h2>" in page and "the correction was fitted" not in page


def test_a_healthy_machine_has_no_causes(healthy):
    page = render(healthy, "toy")
    assert "<h1>No gap" in page and "What causes it" not in page and "How far the gap shrinks" not in page


def test_the_chain_shows_what_was_recorded(rubbing, healthy):
    (column,) = chain(rubbing, Reporter())
    (cell,) = column.cells
    assert (column.name, column.level, cell.label) == ("Motor mechanics", GAP, "axis")
    assert float(cell.text) == pytest.approx(np.sqrt(1 + 3.0**2), rel=0.05)  # noise of one floor, gap of three
    assert chain(healthy, Reporter())[0].level == AT_FLOOR


def test_stages_without_data_are_shown_where_the_machine_asks(rubbing):
    class Every(Reporter):
        every_stage = True

    columns = chain(rubbing, Every())
    assert len(columns) == 8
    assert [c.cells[0].text for c in columns if c.name == "Drive"] == ["not recorded"]


def test_a_card_says_what_came_close(rubbing):
    (card,) = cause_cards(rubbing)
    assert (card.cause.effect, card.cause.actuator) == ("direction", "axis")
    assert "Speed" in [r.name for r in card.rivals] and not any(r.kept for r in card.rivals)


def test_what_tells_two_apart_is_read_from_either_page():
    assert separates(DIRECTION, SPEED) == "Direction: grows with speed"
    assert separates(SPEED, DIRECTION) == "Direction: grows with speed"


def test_no_rival_is_without_a_reason():
    assert separates(OFFSET, DIRECTION) == "the same inputs, another law: `steps`, since steps show it"
    assert separates(SPEED, SPEED) == "the same effect at another place: its own axis moves it"
    warm = Column("warm", "drift", "warmth", inputs=("temperature",))
    assert separates(SPEED, warm) == "Warm depends on temperature, speed on nothing"


def test_effects_of_one_group_stand_beside_a_cause(rubbing):
    class Says(Reporter):
        def isolability(self, parts):
            return Isolability(["effort"], [frozenset({"direction", "speed"})], frozenset({"drive_lag"}))

    class Saying(Toy):
        def reporter(self):
            return Says()

    page = render(replace(rubbing, machine=Saying()), "toy")
    assert "Shows in the same equations as: speed." in page
    assert "<code>effort</code>" in page and "Direction · Speed" in page and "</b> drive lag." in page


def test_groups_and_the_invisible():
    found = Isolability([], [frozenset({"a", "b"}), frozenset({"c"})], frozenset({"d", "e"}))
    assert [found.alike(x) for x in "acd"] == [{"b"}, frozenset(), {"e"}]


def test_excitations_are_counted_and_scales_chosen():
    assert counted(["sweep", "steps", "sweep"]) == "steps × 1, sweep × 2"
    assert scale_of(np.array([0.6])) == (1.0, "")
    assert scale_of(np.array([-4e-4])) == (1e6, "µ")
