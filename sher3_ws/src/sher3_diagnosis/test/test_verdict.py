"""A verdict says what its status promises, and survives its file."""

import pytest
from pydantic import ValidationError
from sher3_diagnosis.verdict import Unexplained, Verdict, Where

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
    assert '"schema": "sher3.verdict/2"' in verdict.to_json()


def test_a_verdict_of_the_first_version_is_still_read_and_a_foreign_one_refused(tmp_path):
    path = tmp_path / "verdict.json"
    path.write_text('{"schema": "sher3.verdict/1", "status": "no_gap", "where": [], "causes": []}')
    assert Verdict.read(path).schema_ == "sher3.verdict/1"
    path.write_text('{"schema": "sher3.verdict/3", "status": "no_gap"}')
    with pytest.raises(ValidationError, match=r"sher3\.verdict/2"):
        Verdict.read(path)
