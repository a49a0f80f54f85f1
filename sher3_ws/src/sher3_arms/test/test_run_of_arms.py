"""The whole path on the arm of our own: sealed, answered, scored."""

import ast
import json
import re
from pathlib import Path
from types import ModuleType

import pytest
import sher3_arms
from sher3_arms import ArmsError, run_arms
from sher3_arms.answer import identification
from sher3_arms.score import Scored, shares, table
from sher3_arms.truth import cases
from sher3_arms.truth.faults import Fault


def test_a_friction_is_sealed_answered_and_scored(tmp_path):
    (found,) = run_arms([0], ["own"], tmp_path / "run", seconds=20.0)
    assert found.kind == "coulomb" and found.top and found.placed
    assert (tmp_path / "run/cases/00000/verdict.json").is_file()
    assert json.loads((tmp_path / "run/scores.json").read_text())[0]["effect"] == found.effect
    with pytest.raises(ArmsError, match="exists already"):
        run_arms([0], ["own"], tmp_path / "run")


def test_beside_a_fault_nothing_is_named_that_is_far_below_the_floor(tmp_path):
    """Half a step by which torques are late looks like an inertia, of a twentieth of the floor."""
    found = run_arms([2006], ["own"], tmp_path / "run")
    assert [x.kind for x in found] == ["spring"] and all(x.top for x in found)
    for path in sorted((tmp_path / "run/cases").glob("*/verdict.json")):
        assert len(json.loads(path.read_text())["causes"]) == 1


def test_a_case_that_no_draw_makes_stable_is_left_out_and_said(tmp_path, monkeypatch):
    monkeypatch.setattr(cases, "deal", lambda *_: Fault("late_drive", 1, 0.08))
    told = []
    assert not run_arms([0], ["own"], tmp_path / "run", 12.0, told.append, kinds=["late_drive"])
    assert "unstable with every late_drive" in told[0] and "left out" in told[0]


def test_a_kind_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(ArmsError, match="no such kind of fault"):
        run_arms([0], ["own"], tmp_path / "run", kinds=["rust"])


def test_without_the_peer_the_extra_is_named_before_anything_is_made(tmp_path, monkeypatch):
    """`mujoco.sysid` without the libraries it needs is there and empty."""
    monkeypatch.setattr(identification, "import_module", lambda name: ModuleType(name))
    with pytest.raises(ArmsError, match=re.escape("sher3[sysid]")):
        run_arms([0], ["own"], tmp_path / "run", beside=True)
    assert not (tmp_path / "run").exists()


def case(kind, status="attributed", effect="coulomb_friction", top=None, placed=None):
    return Scored(1, "own", kind, "turn", status, effect, "turn", top, top, placed, 3.0)


def test_shares_are_of_the_cases_they_are_over():
    found_cases = [
        case("coulomb", top=True, placed=True),
        case("gain", top=False, placed=True),
        case("healthy", status="no_gap"),
        case("heavy_air", status="outside_library"),
        case("foreign_cable"),
    ]
    found = shares(found_cases)
    assert found["top-1"] == (0.5, 2) and found["joint right"] == (1.0, 2)
    assert found["healthy alarms"] == (0.0, 1) and found["outside abstained"] == (0.5, 2)
    assert "slowest answer" in table(found_cases)
    assert "joint right                    1.00  (0.34 .. 1.00)  of 2" in table(found_cases)


SEALED = {"truth": ("sher3_diagnosis", "sher3_machines", "answer"), "answer": ("truth", "score", "run")}


@pytest.mark.parametrize("folder", SEALED)
def test_the_challenge_is_sealed(folder):
    """The truth reaches no code of the diagnosis, and what answers cannot look the truth up."""
    home = Path(sher3_arms.__file__).parent
    for path in (home / folder).glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom) and node.module:
                words = node.module.replace("sher3_arms.", "").split(".")
                assert words[0] not in SEALED[folder], f"{path.name} imports {node.module}"
