"""`sher3 gap monitor`: what it prints."""

import json

import pytest
from invoking import invoke
from sher3_gap.live import gap_monitor_node
from sher3_gap.live.gap_monitor_node import StageStatus
from sher3_gap_cli.app import app


@pytest.mark.parametrize("arguments", [[], ["--json"]])
def test_the_command_prints_one_object_a_second_when_asked(arguments, monkeypatch):
    def run(robot, effects, window, domain, told):
        if told is not None:
            told(1, [], None)
            told(2, [StageStatus("drive", "tilt", 3e-6, 1e-6, "m/s")], None)

    monkeypatch.setattr(gap_monitor_node, "run", run)
    result = invoke(app, ["monitor", *arguments])
    assert result.exit_code == 0, result.output
    rows = [json.loads(line) for line in result.stdout.splitlines()]
    stage = {"stage": "drive", "actuator": "tilt", "gap": 3e-6, "floor": 1e-6, "unit": "m/s", "ratio": 3e-6 / 1e-6}
    none = {"cause": None}
    assert rows == (
        [{"stamp": 1, "stages": [], **none}, {"stamp": 2, "stages": [stage | {"level": 2}], **none}]
        if arguments
        else []
    )
