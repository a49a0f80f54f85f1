"""Every package says the same thing in package.xml, setup.py and the root pyproject."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
from sources import FILES, PACKAGES, ROOT, SOURCES, imports

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
BASE, EXTRAS = PYPROJECT["project"]["dependencies"], PYPROJECT["project"]["optional-dependencies"]
ROBOT, CLUSTER = EXTRAS["robot"], EXTRAS["cluster"]
"""What the diagnosis needs is the base; then what the graph and a cluster of computers need besides."""
INTERFACES = {"std_msgs", "std_srvs", "sensor_msgs", "geometry_msgs", "diagnostic_msgs", "trajectory_msgs"}
ROS_KEYS = INTERFACES | {"rclpy", "rcl_interfaces"}


def manifest(package: str) -> ElementTree.Element:
    return ElementTree.parse(SOURCES / package / "package.xml").getroot()


def setup_arguments(package: str) -> dict:
    """Return the literal keyword arguments of the setup() call."""
    tree = ast.parse((SOURCES / package / "setup.py").read_text())
    call = next(n for n in ast.walk(tree) if isinstance(n, ast.Call) and getattr(n.func, "id", "") == "setup")
    found = {}
    for keyword in call.keywords:
        try:
            found[keyword.arg] = ast.literal_eval(keyword.value)
        except ValueError:
            continue
    return found


@pytest.mark.parametrize("package", PACKAGES)
def test_manifest_is_valid(package):
    """colcon silently takes a package with an invalid manifest for something else."""
    root = manifest(package)
    assert root.tag == "package" and root.get("format") == "3"
    assert root.findtext("name") == package
    assert re.fullmatch(r"[\w.+-]+@[\w-]+(\.[\w-]+)+", root.find("maintainer").get("email"))
    assert root.findtext("export/build_type") == "ament_python"
    assert (SOURCES / package / "resource" / package).is_file()


@pytest.mark.parametrize("package", PACKAGES)
def test_versions_and_licences_agree(package):
    root, arguments = manifest(package), setup_arguments(package)
    assert root.findtext("version") == arguments["version"] == PYPROJECT["project"]["version"]
    assert root.findtext("license") == arguments["license"] == PYPROJECT["project"]["license"]
    assert arguments["extras_require"] == {"test": ["pytest"]}, "colcon test would run unittest and find nothing"


def test_manifests_name_what_is_imported():
    """Packages, libraries, message types and the middleware; `tools/manifests.py` writes them."""
    command = [sys.executable, ROOT / "tools" / "manifests.py", "--check"]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stdout + result.stderr


def test_pyproject_installs_every_package():
    where = PYPROJECT["tool"]["setuptools"]["packages"]["find"]["where"]
    assert sorted(Path(path).name for path in where) == PACKAGES
    paths = PYPROJECT["tool"]["pytest"]["ini_options"]["testpaths"]
    assert {f"sher3_ws/src/{package}/test" for package in PACKAGES} <= set(paths)


def test_third_party_imports_are_declared():
    """A library that is imported is in the project's dependencies, in those of the robot, or has a command's extra."""
    module_of = {
        "pin": "pinocchio",
        "python-can": "can",
        "pyyaml": "yaml",
        "ros-jazzy-rclpy": "rclpy",
        "typing-extensions": "typing_extensions",
    }
    declared = {re.split(r"[\[<>=; ]", text)[0] for text in [*BASE, *ROBOT, *CLUSTER]}
    modules = {module_of.get(name, name) for name in declared} | ROS_KEYS | {"pydantic_core"}
    used = set().union(*map(imports, FILES))
    third_party = {n for n in used if n not in sys.stdlib_module_names and not n.startswith("sher3_")}
    unknown = {name for name in third_party if name not in modules}
    assert not unknown, f"imported but not declared in pyproject.toml: {sorted(unknown)}"


def test_requirements_pin_every_dependency_with_hashes():
    """The lock has all of pyproject.toml, each with a version and a hash."""
    text = (ROOT / "requirements.txt").read_text()
    pinned = {m.group(1).lower(): m.end() for m in re.finditer(r"^([\w.-]+)==", text, re.M)}
    wanted = [*BASE, *ROBOT, *PYPROJECT["project"]["optional-dependencies"]["dev"]]
    names = {re.split(r"[\[<>=; ]", entry)[0].lower().replace("_", "-") for entry in wanted}
    assert names <= {name.replace("_", "-") for name in pinned}
    entries = re.split(r"^(?=[\w.-]+==)", text, flags=re.M)[1:]
    assert all("--hash=sha256:" in entry for entry in entries)
