"""What the search draws and how it climbs; robots are tried in `tests/test_safety_search.py`."""

from dataclasses import replace
from random import Random

import pytest
from sher3_control.motion.speed_cap import Regime
from sher3_faults.budget import CUT_OFF, RUNAWAY
from sher3_safety.search.climb import ROUND, SearchResult, search
from sher3_safety.search.draw import CUTS, OF_ONE, ONSETS, STATES, Draw, Fault, Shape, drawn, near
from sher3_safety.search.trial import Found
from sher3_safety.search.words import NotADraw, read

CREEP = Shape("power", "creep", "speed")
DRAW = Draw((Fault("delta_1.power", CREEP, 0.5, 0), Fault("legs.power", CREEP, -1.0, 7)), STATES[Regime.FREE][0],
            Regime.FREE)  # fmt: skip


@pytest.mark.parametrize("regime", STATES)
def test_a_draw_has_two_or_three_faults_of_different_components_and_begins_at_once(regime):
    random, seen = Random(3), set()
    for _ in range(300):
        draw = drawn(random, regime)
        components = [fault.component for fault in draw.faults]
        assert 2 <= len(components) <= 3 and len(set(components)) == len(components)
        assert min(fault.onset for fault in draw.faults) == 0 and draw.state in STATES[regime]
        assert all(fault.request(regime, 0.002).component == fault.component for fault in draw.faults)
        seen |= {fault.shape for fault in draw.faults}
    assert len(seen) >= 15


@pytest.mark.parametrize("regime", STATES)
def test_a_draw_near_another_has_its_faults_a_little_otherwise(regime):
    random = Random(5)
    for _ in range(100):
        draw = drawn(random, regime)
        child = near(random, draw)
        assert child.regime is regime and [f.component for f in child.faults] == [f.component for f in draw.faults]
        for old, new in zip(draw.faults, child.faults, strict=True):
            assert abs(new.share) <= min(1.0, 2.0 * abs(old.share)) and 0 <= new.onset <= ONSETS


def test_the_size_is_a_share_of_the_limit_of_the_drive_and_the_onset_is_in_ticks():
    """Half of 12.2 mm/s, and all of it 7 ticks of 2 ms later."""
    first, second = [fault.request(Regime.FREE, 0.002) for fault in DRAW.faults]
    assert first.parameters == {"speed": pytest.approx(6.1e-3)} and first.start == 0.0
    assert second.parameters == {"speed": pytest.approx(-12.2e-3)} and second.start == pytest.approx(0.014)


def test_the_worst_is_the_one_nearest_to_its_budget_and_one_beyond_it_misses():
    small, large, near_one = (Found(DRAW, x, n, 4) for x, n in ((10e-6, "A"), (251e-6, "B"), (249e-6, "C")))
    result = SearchResult([small, large, near_one], 1)
    assert result.worst(2) == [large, near_one] and result.missed == [large]
    assert (
        "3 draws, seed 1: 1 beyond their budget." in result.as_text() and "| B | 251.0 | 250 | 4 |" in result.as_text()
    )
    assert result.to_dict()["trials"][0]["faults"] == DRAW.in_words()


@pytest.mark.parametrize(
    ("component", "shape", "stated"),
    [("bus", CUTS[1], True), ("delta_2", CUTS[0], True), ("tilt", CUTS[0], False), ("delta_2.up", OF_ONE[3], False)],
)
def test_an_axis_that_goes_by_itself_and_is_cut_off_is_held_against_what_is_stated(component, shape, stated):
    draw = replace(DRAW, faults=(DRAW.faults[1], Fault(component, shape, 1.0, 0)))
    assert draw.budget == (CUT_OFF if stated else RUNAWAY)[Regime.FREE]


def test_the_same_seed_draws_the_same():
    assert drawn(Random(9), Regime.FREE) == drawn(Random(9), Regime.FREE)


@pytest.mark.parametrize("regime", STATES)
def test_a_draw_is_read_from_the_line_that_tells_it(regime):
    """Of a fault without a drawn size the share is not told, since it means nothing."""
    random = Random(7)
    for _ in range(300):
        draw = drawn(random, regime)
        same = read(f"| {draw.line(17)} | POSITION_LEFT | 12.3 | 40 |")
        assert same.line(17) == draw.line(17) and same.budget == draw.budget
        assert [f.shape for f in same.faults] == [f.shape for f in draw.faults]
        assert [f.request(regime, 0.002) for f in same.faults] == [f.request(regime, 0.002) for f in draw.faults]


def test_commas_do_as_well_as_bars():
    line = "free, paused, tilt.power creep speed 0.009 at 3"
    assert read(line).line() == line.replace(", ", " | ")


@pytest.mark.parametrize(
    "text", ["", "free | idle", "free | asleep | tilt.power creep speed 1 at 0", "free | idle | tilt"]
)
def test_what_is_no_line_is_refused_with_an_example(text):
    with pytest.raises(NotADraw, match="no draw"):
        read(text)


def test_a_search_goes_on_from_what_is_kept_as_if_it_had_not_ended(tmp_path, monkeypatch):
    """Trials by a formula: the sum of the onsets is the travel in um."""
    tried = []

    def formula(draws, robot, seed):
        tried.append(len(draws))
        return [Found(draw, 1e-6 * sum(f.onset for f in draw.faults), "A", seed) for draw in draws]

    monkeypatch.setattr("sher3_safety.search.climb.try_all", formula)
    whole = search(100, seed=5)
    first = search(50, seed=5, kept=tmp_path)
    assert search(100, seed=5, kept=tmp_path) == whole and whole.found[:50] == first.found
    assert tried == [ROUND] * 8 and search(100, seed=5, kept=tmp_path) == whole and len(tried) == 8
    assert search(25, seed=6, kept=tmp_path).found != whole.found[:25]


def test_an_axis_that_goes_while_both_its_encoders_drift_is_not_drawn():
    drift = Fault("legs.encoders", Shape("encoders", "drift", "rate"), 0.1, 0)
    assert replace(DRAW, faults=(DRAW.faults[0], drift)).hidden
    assert not replace(DRAW, faults=(replace(DRAW.faults[0], component="tilt.power"), drift)).hidden
    random = Random(4)
    found = [drawn(random, Regime.NEAR_TISSUE) for _ in range(2000)]
    assert not any(draw.hidden for draw in found)
    assert any(fault.shape == drift.shape for draw in found for fault in draw.faults)
