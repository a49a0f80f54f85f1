"""Calibration in pieces: a seed alone says its plant and kind, so that ranges hold as many of each and add up."""

from collections import Counter

import pytest
from sher3_challenge.calibration import drawn
from sher3_challenge.calibration.observe import Observation

PLANTS = ("lumped", "tables", "mujoco")


@pytest.fixture
def dealt(monkeypatch):
    """Plant and kind of every case that is drawn; none is simulated."""
    found = {}

    def evidence_of(robot, plant, kind, seed):
        found[seed] = (plant, kind)
        return [Observation(plant, f"case_{seed}", {}, (), (), (), (), False)]

    monkeypatch.setattr(drawn, "evidence_of", evidence_of)
    return found


def test_any_27_seeds_hold_each_plant_and_kind_as_often(dealt, tmp_path):
    list(drawn.draw(PLANTS, range(900_005, 900_032), tmp_path))
    assert Counter(dealt.values()) == Counter((p, k) for p in PLANTS for k in drawn.TURN)


def test_pieces_hold_the_cases_of_the_whole(dealt, tmp_path):
    whole = [r for rows in drawn.draw(PLANTS, range(40), tmp_path / "whole") for r in rows]
    pieces = [r for a in (0, 7, 25) for rows in drawn.draw(PLANTS, range(a, 40), tmp_path / "pieces") for r in rows]
    assert {(r.plant, r.case) for r in pieces} == {(r.plant, r.case) for r in whole}


def test_what_is_kept_is_not_drawn_again_and_after_the_time_nothing_is(dealt, tmp_path):
    list(drawn.draw(PLANTS, range(3, 6), tmp_path))
    dealt.clear()
    late = list(drawn.draw(PLANTS, range(9), tmp_path, seconds=0.0))
    assert [rows[0].case for rows in late] == ["case_3", "case_4", "case_5"] and not dealt
    assert len(list(drawn.draw(PLANTS, range(9), tmp_path))) == 9 and sorted(dealt) == [0, 1, 2, 6, 7, 8]
