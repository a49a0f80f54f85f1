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
    assert '"schema": "sher3.verdict/1"' in verdict.to_json()
