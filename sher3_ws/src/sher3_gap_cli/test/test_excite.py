"""`sher3 gap excite`: the list, and excitations run in the simulator."""

import json

import numpy as np
import pytest
from invoking import invoke
from sher3_bags import read_case
from sher3_gap.excitation import catalogue
from sher3_gap_cli.app import app
from simulated import ROBOT


def test_the_standard_set_is_listed():
    listed = json.loads(invoke(app, ["excite", "--json"]).stdout)["excitations"]
    assert [e["name"] for e in listed] == list(catalogue())


def test_simulated_excitations_make_a_case(tmp_path):
    effects = tmp_path / "effects.yaml"
    effects.write_text(
        "schema: sher3.effects/1\neffects: [{effect: lead_error, actuator: roll, parameters: {relative: 0.005}}]\n"
    )
    arguments = ["excite", "sweep,task_0.8", "--simulate", "--repeats", "2", "--duration", "2.5", "--json"]
    result = invoke(app, [*arguments, "--effects", str(effects), "-o", str(tmp_path / "case")])
    assert result.exit_code == 0, result.output
    case = read_case(tmp_path / "case")
    assert [r.metadata.excitation for r in case.runs] == ["sweep", "sweep", "task_0.8", "task_0.8"]
    roll = case.runs[0]["measured_js"].position[:, 3] - case.runs[0]["drives/measured_js"].position[:, 3]
    assert np.ptp(roll) > 5 * ROBOT.actuators[3].motor_encoder


@pytest.mark.parametrize("which", ["gallop", "sweep_9", "gone.yaml"])
def test_unknown_excitations_are_refused(which, tmp_path):
    result = invoke(app, ["excite", which, "--simulate", "-o", str(tmp_path / "case")])
    assert result.exit_code == 2 and result.stderr.startswith("sher3: ")
