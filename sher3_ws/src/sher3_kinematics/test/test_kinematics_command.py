"""The commands fk and ik: they undo each other, speak JSON, and fail in one sentence."""

import json

import numpy as np
import pytest
from invoking import invoke as run
from sher3_kinematics import RobotKinematics
from sher3_kinematics.cli import app


def test_fk_and_ik_undo_each_other() -> None:
    q = [0.004, -0.003, 0.001, -0.2, 0.005]
    pose = json.loads(run(app, ["fk", *map(str, q), "--json"]).stdout)
    numbers = [*pose["position"], *pose["axis"]]
    back = json.loads(run(app, ["ik", *map(repr, numbers), "--json"]).stdout)["q"]
    assert list(back.values()) == pytest.approx(q, abs=1e-12)


def test_fk_json_is_the_library(kinematics: RobotKinematics) -> None:
    pose = json.loads(run(app, ["fk", "0.001", "0", "0", "0.1", "0", "--json"]).stdout)
    transform = kinematics.transform_tip_to_base([0.001, 0, 0, 0.1, 0])
    assert np.abs(np.array(pose["position"]) - transform[:3, 3]).max() == 0
    assert pose["units"] == "m, rad"


def test_millimetres_and_degrees() -> None:
    si = json.loads(run(app, ["fk", "0.001", "0", "0", str(np.radians(5)), "0", "--json"]).stdout)
    human = json.loads(run(app, ["fk", "--mm-deg", "1", "0", "0", "5", "0", "--json"]).stdout)
    assert human["position"] == pytest.approx(si["position"], abs=1e-12)
    shown = run(app, ["ik", "--mm-deg", "200", "0", "97"])
    assert "mm" in shown.stdout
    assert "deg" in shown.stdout


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["fk", "0", "0"], "wrong number of positions"),
        (["fk", "4", "0", "0", "0", "0"], "beyond its travel"),
        (["fk", "nan", "0", "0", "0", "0"], "not finite"),
        (["ik", "0.2", "0", "0.5"], "outside the workspace"),
        (["ik", "0.2", "0"], "wrong number"),
        (["ik", "0.2", "0", "0.1", "0", "0", "0"], "no direction"),
        (["fk", "0", "0", "0", "0", "0", "--robot", "/nonexistent.yaml"], "no such file"),
    ],
)
def test_errors_are_one_sentence_and_exit_code_one(arguments: list[str], says: str) -> None:
    result = run(app, arguments)
    assert result.exit_code == 2
    assert says in result.stderr
    assert result.stdout == ""
    as_json = run(app, [*arguments, "--json"])
    assert as_json.exit_code == 2
    assert says in json.loads(as_json.stderr)["what"]


def test_help_has_examples() -> None:
    for command in ("fk", "ik"):
        assert f"sher3 {command}" in run(app, [command, "--help"]).stdout
