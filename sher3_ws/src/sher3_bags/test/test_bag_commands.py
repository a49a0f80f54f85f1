"""The commands: exit codes, one sentence per failure, JSON that parses."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest
from invoking import invoke
from sher3_bags import read_run, write_case, write_run
from sher3_bags.cli import app
from sher3_description import load_robot
from sher3_runtime.domains import PROCESSES, claim_domain


@pytest.fixture
def bag(tmp_path, build):
    return write_run(tmp_path / "bag", build(300))


def test_help_has_an_example_for_each_command():
    for name in ("record", "replay", "compare", "recover", "info"):
        result = invoke(app, [name, "--help"])
        assert result.exit_code == 0
        assert "Example: sher3 " + name in result.output.replace("\n", " ")


def test_compare_info_recover(bag, tmp_path):
    data = json.loads(invoke(app, ["compare", str(bag), str(bag), "--json"]).output)
    assert data["alignment"] == "stamp"
    assert data["residuals"]["measured_js"]["position"][0]["max"] == 0
    picture = bag.parent / "difference.png"
    assert str(picture) in invoke(app, ["compare", str(bag), str(bag), "--picture", str(picture)]).output
    assert picture.stat().st_size > 10_000
    result = invoke(app, ["compare", str(bag), str(bag), "--picture", str(bag.parent / "a.xyz")])
    assert (result.exit_code, "cannot be drawn" in result.output) == (2, True)
    assert "b - a" in invoke(app, ["compare", str(bag), str(bag), "--topic", "measured_js"]).output
    data = json.loads(invoke(app, ["info", str(bag), "--json"]).output)
    assert data["topics"]["force/measured_cf"]["frame_id"] == "f"
    assert data["run"]["excitation"] == "sweep"
    assert "sensor_msgs/msg/Joy" in invoke(app, ["info", str(bag)]).output
    data = json.loads(invoke(app, ["recover", str(bag), "--json"]).output)
    assert data["cause"] is None


@pytest.mark.parametrize(
    "arguments",
    [
        ["info", "missing"],
        ["recover", "missing"],
        ["compare", "missing", "missing"],
        ["replay", "missing"],
    ],
)
def test_failures_are_one_sentence(arguments, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    result = invoke(app, arguments)
    assert result.exit_code == 2
    assert result.output.startswith("sher3: missing: no such file or folder;")
    error = json.loads(invoke(app, [*arguments, "--json"]).output)
    assert error["error"] == "ForeignBagError"


def test_other_failures(bag, tmp_path):
    result = invoke(app, ["compare", str(bag), str(bag), "--align", "phase"])
    assert (result.exit_code, "unknown alignment; value phase" in result.output) == (2, True)
    result = invoke(app, ["replay", str(bag), "--rate", "0"])
    assert (result.exit_code, "rate must be positive" in result.output) == (2, True)


COMMAND = [sys.executable, "-c", "from sher3_bags.cli import app; app()"]


@pytest.mark.graph
@pytest.mark.flaky(reruns=2)
def test_record_and_replay_in_two_processes(bag, tmp_path):
    """The recorder sees every message of the replay, stops at SIGINT and leaves a whole bag."""
    environment = {**os.environ, "ROS_DOMAIN_ID": str(claim_domain(PROCESSES))}
    target = tmp_path / "again"
    topics = ["--topic", "measured_js", "--topic", "servo_jv"]
    recorder = subprocess.Popen(
        [*COMMAND, "record", str(target), "--json", *topics], env=environment, stdout=subprocess.PIPE, text=True
    )
    replay = [*COMMAND, "replay", str(bag), "--wait-for", "1", "--json", *topics]
    sent = json.loads(subprocess.run(replay, env=environment, capture_output=True, check=True, timeout=60).stdout)
    time.sleep(0.1)
    recorder.send_signal(signal.SIGINT)
    counts = json.loads(recorder.communicate(timeout=30)[0])["topics"]
    assert recorder.returncode == 0
    assert sent["sent"] == sent["messages"] == 600
    assert {name: entry["messages"] for name, entry in counts.items()} == {"measured_js": 300, "servo_jv": 300}
    run = read_run(target)
    assert len(run["measured_js"]) == 300
    assert run["measured_js"].log_time[0] > run["measured_js"].stamp[0]


def test_info_of_a_case_is_a_run_to_a_line(tmp_path, build):
    case = write_case(tmp_path / "case", [build(200), build(200, seed=2)], load_robot())
    text = invoke(app, ["info", str(case)]).output
    assert "a case of 2 runs" in text and "sweep" in text and "run_01" in text
    data = json.loads(invoke(app, ["info", str(case), "--json"]).output)
    assert [run["loads"] for run in data["runs"]] == [1, 1]
    assert data["runs"][0]["duration"] == pytest.approx(0.398)


def test_a_comparison_has_a_unit_in_every_row(bag):
    data = json.loads(invoke(app, ["compare", str(bag), str(bag), "--json"]).output)
    units = {axis["axis"]: axis["unit"] for axis in data["residuals"]["measured_js"]["position"]}
    assert units == {"delta_1": "m", "delta_2": "m", "delta_3": "m", "roll": "rad", "tilt": "m"}
    assert {axis["unit"] for axis in data["residuals"]["force/measured_cf"]["torque"]} == {"N m"}
