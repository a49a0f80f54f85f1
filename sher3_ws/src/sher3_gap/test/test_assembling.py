"""A case made of recordings."""

import numpy as np
import pytest
from sher3_bags import Run, RunMetadata, read_case, stream, write_run
from sher3_description import load_robot
from sher3_gap.case.assembling import assemble
from sher3_gap.errors import CaseError

ROBOT = load_robot()
TEXT = ROBOT.to_yaml()


def recording(path, excitation, topic="drives/measured_js", robot=TEXT):
    rows = np.zeros((20, 5))
    streams = {topic: stream(topic, 10**9 + 2_000_000 * np.arange(20), position=rows)}
    write_run(path, Run(streams, RunMetadata(excitation, 7, 1.0), robot))
    return path


def test_runs_of_one_excitation_become_its_repeats(tmp_path):
    bags = [recording(tmp_path / name, x) for name, x in (("a", "sweep"), ("b", "sweep"), ("c", ""))]
    found = assemble(bags, tmp_path / "case")
    assert [(x.excitation, x.repeat) for x in found] == [("sweep", 0), ("sweep", 1), ("c", 0)]
    case = read_case(tmp_path / "case")
    assert [run.metadata.repeat for run in case.runs] == [0, 1, 0] and case.robot.digest() == ROBOT.digest()


def test_what_makes_no_case_is_refused_by_name(tmp_path):
    good = recording(tmp_path / "good", "sweep")
    with pytest.raises(CaseError, match=r"measured_js.*is missing"):
        assemble([good, recording(tmp_path / "poor", "sweep", "measured_js")], tmp_path / "case")
    with pytest.raises(CaseError, match="--robot"):
        assemble([good, recording(tmp_path / "bare", "sweep", robot=None)], tmp_path / "case")
    other = TEXT.replace("position_gain: 20.0", "position_gain: 21.0")
    with pytest.raises(CaseError, match="another robot"):
        assemble([good, recording(tmp_path / "other", "sweep", robot=other)], tmp_path / "case")
    assert not (tmp_path / "case").exists()
