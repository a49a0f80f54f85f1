"""A wheel, installed where nothing of the working copy is seen, is complete and runs the demo."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from fresh_environment import fresh_environment, see_libraries
from sources import FILES, PACKAGES, ROOT, SOURCES

pytestmark = [pytest.mark.slow, pytest.mark.timeout(600)]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    """Return the wheel, built from a copy so that no left-over of an earlier build is in it."""
    folder = tmp_path_factory.mktemp("wheel")
    ignore = shutil.ignore_patterns("__pycache__", "build", "install", "log", "*.egg-info")
    shutil.copytree(ROOT / "sher3_ws", folder / "project" / "sher3_ws", ignore=ignore)
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, folder / "project" / name)
    pip = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "--wheel-dir", folder]
    subprocess.run([*pip, folder / "project"], check=True)
    return next(folder.glob("*.whl"))


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory) -> Path:
    """Return the interpreter of a fresh environment with the wheel and our libraries."""
    python = fresh_environment(tmp_path_factory.mktemp("installed") / "venv")
    pip = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--no-index", wheel]
    subprocess.run(pip, check=True)
    see_libraries(python)
    return python


def run(command: list, folder: Path) -> subprocess.CompletedProcess:
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)


def test_it_holds_every_file_of_the_packages(wheel: Path):
    """Sources and the data beside them: descriptions, templates, scripts, profiles."""
    data = [path for name in PACKAGES for path in (SOURCES / name / name).rglob("*") if path.is_file()]
    wanted = {path for path in {*FILES, *data} if "__pycache__" not in path.parts}
    names = {"/".join(path.relative_to(SOURCES).parts[1:]) for path in wanted}
    held = set(zipfile.ZipFile(wheel).namelist())
    assert not names - held
    tops = {name.split("/")[0] for name in held if ".dist-info/" not in name}
    assert tops == {*PACKAGES, "sher3"}, "a folder beside the packages would be a package of the user's environment"


def test_it_is_what_runs(installed: Path, tmp_path: Path):
    """Every package comes from the environment, none from the working copy."""
    script = (
        "import importlib.util as u, sys\n"
        f"where = {{name: u.find_spec(name).origin for name in {PACKAGES}}}\n"
        "print([name for name, path in where.items() if not path.startswith(sys.prefix)])"
    )
    assert run([installed, "-c", script], tmp_path).stdout.strip() == "[]"


@pytest.mark.graph
def test_it_runs_the_demo(installed: Path, tmp_path: Path):
    result = run([installed.with_name("sher3"), "demo", "--json", "--folder", tmp_path / "bags"], tmp_path)
    assert result.returncode == 0, result.stdout[-2000:] + result.stderr[-2000:]
    assert json.loads(result.stdout.splitlines()[-1])
    assert list(tmp_path.glob("bags/*"))
