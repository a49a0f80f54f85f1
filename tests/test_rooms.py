"""Rooms and doors: who may import what, read from the sources and checked against docs/architecture.md."""

from __future__ import annotations

import re
from fnmatch import fnmatch
from pathlib import Path

import pytest
from sources import FILES, PACKAGES, ROOT, imports, package_of

ROS = {
    "rclpy",
    "rcl_interfaces",
    "rosgraph_msgs",
    "builtin_interfaces",
    "std_msgs",
    "std_srvs",
    "sensor_msgs",
    "geometry_msgs",
    "diagnostic_msgs",
}


def allowed() -> dict[str, set[str]]:
    """Return the "may import" column of the table of packages."""
    rows = re.findall(r"^\| `(sher3_\w+)` \|.*\| (.+) \|$", (ROOT / "docs" / "architecture.md").read_text(), re.M)
    short = set(PACKAGES)
    return {
        package: short if column == "all" else {f"sher3_{word}" for word in column.split(", ")} & short
        for package, column in rows
    }


def test_the_table_names_every_package():
    assert sorted(allowed()) == PACKAGES


@pytest.mark.parametrize("package", PACKAGES)
def test_packages_import_only_what_the_table_allows(package):
    """Nodes are the doors to the graph: they may see the runtime, and a node on mocks the device ends it plays."""
    for path in FILES:
        if package_of(path) != package:
            continue
        doors = {"sher3_runtime"} if is_door(path) else set()
        if path.name == "plant_node.py":
            doors.add("sher3_drivers")
        used = {name for name in imports(path) if name.startswith("sher3_")} - {package}
        assert used <= allowed()[package] | doors, f"{path.relative_to(ROOT)} imports {sorted(used)}"


def is_door(path: Path) -> bool:
    return fnmatch(path.name, "*_node.py") or fnmatch(path.name, "cli.py")


@pytest.mark.parametrize(
    ("modules", "doors"),
    [
        (ROS, ("sher3_runtime/*", "*/*_node.py")),
        ({"can", "canopen"}, ("sher3_drivers/bus*.py", "sher3_drivers/canopen_*.py")),
        ({"mcap"}, ("sher3_bags/*",)),
    ],
    ids=["ros", "can", "mcap"],
)
def test_doors(modules, doors):
    """A library with side effects is imported in the files named for it and nowhere else."""
    for path in FILES:
        here = f"{package_of(path)}/{path.name}"
        if used := imports(path) & modules:
            assert any(fnmatch(here, door) for door in doors), f"{path.relative_to(ROOT)} imports {sorted(used)}"


def test_the_doors_are_looked_for_where_they_are():
    """The test above must be able to fail: the libraries are imported somewhere, also inside functions."""
    for module in ("rclpy", "can", "canopen"):
        assert any(module in imports(path) for path in FILES), module


def test_files_are_short():
    """A file is read in one sitting."""
    lengths = {str(path.relative_to(ROOT)): len(path.read_text().splitlines()) for path in FILES}
    assert not {path: n for path, n in lengths.items() if n > 400}


def test_the_project_names_no_download_host():
    """Nothing in the project says where to download from: machines differ."""
    hosts = re.compile(
        r"https?://[\w.-]*(pypi|pythonhosted|anaconda|jfrog|artifactory)[\w.-]*|--(extra-)?index-url", re.I
    )
    names = ["requirements*.txt", "Makefile", "pyproject.toml", ".ci/*", "docker/*", "tools/*", "tests/*.txt"]
    for path in (path for name in names for path in ROOT.glob(name) if path.is_file()):
        assert not hosts.search(path.read_text()), path
