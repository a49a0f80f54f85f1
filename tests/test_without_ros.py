"""The diagnosis alone: nothing that only the robot needs may be imported by it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from importlib.metadata import packages_distributions
from pathlib import Path

import numpy as np
import pytest

MASS, FORCE, PERIOD = 3.0, 2.0, 0.002
"""Mass (kg), Coulomb friction (N) and period (s) of the slide."""
DESCRIPTION = f"""
kind: axes
name: slide
time: {{column: t, unit: s}}
axes:
  - name: slide
    motion: linear
    signals:
      position: {{column: q, unit: m}}
      effort: {{column: f, unit: N}}
    command_law: {{kind: none}}
    mass: {MASS}
    encoder_resolution: 1.0e-6
"""
LIBRARIES = ("python-can", "canopen", "mcap", "rosbags", "zstandard", "lz4")
"""Libraries beside those of ROS that the base does not bring."""
BLOCKED = """
import sys


class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {names}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)


sys.meta_path.insert(0, Absent())
from sher3_cli.root import main

main()
"""


@pytest.fixture(scope="module")
def names() -> set[str]:
    """Packages that only the robot needs."""
    owners = packages_distributions().items()
    found = {n for n, of in owners if any(d.startswith("ros-") or d in LIBRARIES for d in of)}
    assert {"rclpy", "sensor_msgs", "can", "canopen", "mcap"} <= found
    return found | {"pinocchio"}  # its files lie below a prefix of their own, where packages are not looked for


@pytest.fixture
def alone(tmp_path: Path, names: set[str]):
    """Return `run(*arguments)`: the command line where no library of the robot can be imported."""
    script = tmp_path / "alone.py"
    script.write_text(BLOCKED.format(names=names))
    environment = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "AMENT_PREFIX_PATH")}

    def run(*arguments: object) -> subprocess.CompletedProcess:
        command = [sys.executable, script, *map(str, arguments)]
        return subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)

    return run


def test_a_case_is_imported_and_diagnosed(alone, tmp_path: Path):
    t = np.arange(0.0, 12.0, PERIOD)
    q = 0.04 * np.sin(1.3 * t) + 0.015 * np.sin(4.1 * t)
    v = 0.052 * np.cos(1.3 * t) + 0.0615 * np.cos(4.1 * t)
    a = -0.0676 * np.sin(1.3 * t) - 0.25215 * np.sin(4.1 * t)
    force = MASS * a + FORCE * np.tanh(v / 1e-3) + 0.02 * np.random.default_rng(2).normal(size=len(t))
    columns = np.column_stack([t, 1e-6 * np.round(q / 1e-6), force])
    np.savetxt(tmp_path / "slide.csv", columns, delimiter=",", header="t,q,f", comments="", fmt="%.9f")
    (tmp_path / "slide.yaml").write_text(DESCRIPTION)
    for command in (("import", "slide.csv", "slide.yaml", "--out", "case"), ("diagnose", "case")):
        result = alone("gap", *command)
        assert result.returncode == 0, result.stdout + result.stderr
    verdict = json.loads((tmp_path / "gap" / "case" / "verdict.json").read_text())
    (cause,) = verdict["causes"]
    assert cause["effect"] == "coulomb_friction"
    assert cause["parameters"]["force"]["value"] == pytest.approx(FORCE, rel=0.03)


@pytest.mark.parametrize(
    ("words", "extra"),
    [("record bag", "robot"), ("info bag", "bags"), ("gap import log.mcap slide.yaml --out case", "bags")],
)
def test_what_the_base_lacks_says_which_extra_brings_it(alone, tmp_path, words, extra):
    (tmp_path / "slide.yaml").write_text(DESCRIPTION)
    (tmp_path / "log.mcap").write_bytes(b"0")
    result = alone(*words.split())
    assert result.returncode == 2
    assert f"sher3[{extra}]" in result.stderr and "Traceback" not in result.stderr


def test_what_is_no_case_is_said_all_the_same(alone):
    result = alone("gap", "diagnose", "nowhere")
    assert result.returncode == 2 and "nowhere: no such folder" in result.stderr
