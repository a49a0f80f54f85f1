"""The workspace builds and passes its tests with colcon too, in an environment of its own."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from fresh_environment import fresh_environment, see_libraries
from sources import PACKAGES, ROOT

pytestmark = [pytest.mark.slow, pytest.mark.timeout(900)]


@pytest.fixture(scope="module")
def colcon(tmp_path_factory):
    """Return `run(*arguments, ros=None)`: colcon in a copy of the workspace, with the prefix of a ROS for CMake.

    colcon needs a setuptools below 80, which this environment lacks; the new one sees our libraries behind its own.
    """
    folder = tmp_path_factory.mktemp("colcon")
    python = fresh_environment(folder / "venv")
    pip = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--require-hashes"]
    install = subprocess.run([*pip, "-r", ROOT / "tests" / "colcon.txt"], capture_output=True, text=True, check=False)
    if install.returncode:
        pytest.skip(f"colcon cannot be installed here: {install.stderr.splitlines()[-1]}")
    see_libraries(python)
    ignore = shutil.ignore_patterns("__pycache__", "build", "install", "log", "*.egg-info")
    shutil.copytree(ROOT / "sher3_ws", folder / "project" / "sher3_ws", ignore=ignore)
    for name in ("pyproject.toml", "docs", "bench", "tests"):
        source = ROOT / name
        (shutil.copytree if source.is_dir() else shutil.copy)(source, folder / "project" / name)

    def run(*arguments: str, ros: Path | None = None) -> subprocess.CompletedProcess:
        first = ":".join(map(str, [python.parent, *([] if ros is None else [ros / "bin"])]))
        environment = {**os.environ, "PATH": f"{first}:{os.environ['PATH']}", "PYTHONWARNINGS": "ignore"}
        environment |= {"COLCON_HOME": str(folder / "home")}
        if ros is not None:
            environment |= {"AMENT_PREFIX_PATH": str(ros), "CMAKE_PREFIX_PATH": str(ros)}
        result = subprocess.run(
            [python.parent / "colcon", *arguments],
            cwd=folder / "project" / "sher3_ws",
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert result.returncode == 0, result.stdout[-4000:] + result.stderr[-4000:]
        return result

    return run


def test_colcon_knows_every_package(colcon):
    """An invalid manifest would turn a package into a plain Python one without a word."""
    lines = [line.split() for line in colcon("list", "--base-paths", "src").stdout.splitlines()]
    assert sorted(name for name, *_ in lines) == PACKAGES
    assert {kind for *_, kind in lines} == {"(ros.ament_python)"}


def test_colcon_builds_and_tests(colcon):
    """Without the interfaces (below), and tests that have run already: those with several packages."""
    colcon("build", "--base-paths", "src", "--executor", "sequential")
    select = "not graph and not slow and not shared"
    test = ["test", "--base-paths", "src", "--executor", "sequential", "--return-code-on-test-failure"]
    colcon(*test, "--pytest-args", "-m", select, "-q")
    result = colcon("test-result")
    assert "0 errors, 0 failures" in result.stdout


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_colcon_builds_the_messages(colcon, tmp_path):
    ros = tmp_path / "ros"
    subprocess.run([ROOT / "tools" / "message-generators", sys.prefix, ros], check=True)
    options = [f"-DPython3_EXECUTABLE={ros}/bin/python", f"-DCMAKE_PROJECT_INCLUDE={ROOT}/tools/wheel_targets.cmake"]
    build = ["build", "--base-paths", "interfaces", "--build-base", "build_messages", "--install-base", "messages"]
    colcon(*build, "--executor", "sequential", "--cmake-args", "-DBUILD_TESTING=OFF", *options, ros=ros)
    listed = colcon("list", "--base-paths", "interfaces").stdout
    assert "crtk_msgs" in listed and "sher3_msgs" in listed
