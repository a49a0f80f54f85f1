"""A verdict says what its status promises, and survives its file."""

import pytest
from pydantic import ValidationError
from sher3_diagnosis.verdict import Answer, Place, Unexplained, Verdict, Where

PLACE = Where(stage="drive", actuator="roll", gap=2.0, floor=1.0, unit="N", regime="everywhere", confidence=0.9)


@pytest.mark.parametrize(
    "fields",
    [
        {"status": "no_gap", "where": [PLACE]},
        {"status": "attributed"},
        {"status": "attributed", "where": [PLACE]},
        {"status": "under_excited", "where": [PLACE]},
        {"status": "outside_library", "where": [PLACE]},
        {"status": "solved"},
        {"status": "no_gap", "seconds": float("nan")},
    ],
)
def test_what_contradicts_itself_is_refused(fields):
    with pytest.raises(ValidationError):
        Verdict(**fields)


def test_a_file_comes_back_as_it_went(tmp_path):
    unexplained = Unexplained(stage="drive", actuator="roll", signature="largest everywhere")
    verdict = Verdict(status="outside_library", where=[PLACE], unexplained=unexplained)
    verdict.write(tmp_path / "verdict.json")
    assert Verdict.read(tmp_path / "verdict.json") == verdict
    assert '"schema": "sher3.verdict/3"' in verdict.to_json()


def test_verdicts_of_the_versions_before_are_still_read_and_a_foreign_one_refused(tmp_path):
    path = tmp_path / "verdict.json"
    for version in ("sher3.verdict/1", "sher3.verdict/2"):
        path.write_text(f'{{"schema": "{version}", "status": "no_gap", "where": [], "causes": []}}')
        assert Verdict.read(path).schema_ == version
    path.write_text('{"schema": "sher3.verdict/4", "status": "no_gap"}')
    with pytest.raises(ValidationError, match=r"sher3\.verdict/3"):
        Verdict.read(path)


def test_the_answers_to_a_place_add_up_to_one():
    outside, none = (Answer(answer=a, probability=p) for a, p in (("outside_library", 0.7), ("no_gap", 0.2)))
    place = {"stage": "drive", "actuator": "roll", "gap": 2.0, "floor": 1.0, "unit": "N"}
    assert Place(**place, answers=[outside, none], other=0.1).bet is None
    with pytest.raises(ValidationError, match=r"add up to 0\.9"):
        Place(**place, answers=[outside, none])
    with pytest.raises(ValidationError, match="causes, outside_library or no_gap"):
        Answer(probability=0.5)
