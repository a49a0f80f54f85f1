"""Rooms and doors: who may import what, read from the sources and checked against docs/reference/architecture.md."""

from __future__ import annotations

import re
from collections import Counter
from fnmatch import fnmatch
from pathlib import Path

import pytest
from sources import FILE_OF, FILES, PACKAGES, ROOT, SOURCES, imports, modules, package_of, reached

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
    rows = re.findall(
        r"^\| `(sher3_\w+)` \|.*\| (.+) \|$", (ROOT / "docs" / "reference" / "architecture.md").read_text(), re.M
    )
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


def test_no_two_test_modules_share_a_name():
    """A failure is named by its module alone, and what one imports of another is found on one path of all."""
    named = Counter(path.name for folder in ("sher3_ws", "tests") for path in (ROOT / folder).rglob("test_*.py"))
    assert not [name for name, count in named.items() if count > 1]


def is_door(path: Path) -> bool:
    return fnmatch(path.name, "*_node.py") or fnmatch(path.name, "cli.py")


@pytest.mark.parametrize(
    ("libraries", "doors"),
    [
        (ROS, ("sher3_runtime/*", "*/*_node.py")),
        ({"can", "canopen"}, ("sher3_drivers/bus/*", "sher3_drivers/canopen/*")),
        ({"mcap"}, ("sher3_bags/*",)),
    ],
    ids=["ros", "can", "mcap"],
)
def test_doors(libraries, doors):
    """A library with side effects is imported in the files named for it and nowhere else."""
    for path in FILES:
        here = path.relative_to(ROOT / "sher3_ws" / "src" / package_of(path)).as_posix()
        if used := imports(path) & libraries:
            assert any(fnmatch(here, door) for door in doors), f"{path.relative_to(ROOT)} imports {sorted(used)}"


KNOWING = ("plants", "cases", "oracle")
"""Folders of the challenge that know the truth."""
ANSWERING = ("answers", "baselines")
"""Folders of the challenge that answer."""
SEAL = {
    KNOWING: (
        "sher3_diagnosis",
        "sher3_effects",
        "sher3_sim",
        "sher3_machines",
        "sher3_chain",
        "sher3_static",
        *ANSWERING,
    ),
    ANSWERING: (*KNOWING, "score", "run"),
}
"""Folders -> packages, and modules of the challenge, that they never reach."""


@pytest.mark.parametrize(("folders", "sealed"), SEAL.items(), ids=["knowing", "answering"])
def test_the_challenge_is_sealed(folders, sealed):
    """The truth comes from no code of the diagnosis, and whoever answers cannot look it up; also not at second hand."""
    room = ROOT / "sher3_ws" / "src" / "sher3_challenge" / "sher3_challenge"
    files = [path for folder in folders for path in sorted((room / folder).rglob("*.py"))]
    assert len(files) > len(folders)
    for path in files:
        known = {name.removeprefix("sher3_challenge.").split(".")[0] for name in reached(path)}
        assert not known & set(sealed), f"{path.relative_to(ROOT)} reaches {sorted(known & set(sealed))}"


PLANTS = ROOT / "sher3_ws" / "src" / "sher3_challenge" / "sher3_challenge" / "plants"
"""Truth plants, a folder for each."""


@pytest.mark.parametrize("plant", sorted(path.name for path in PLANTS.iterdir() if (path / "truth.py").exists()))
def test_truth_plants_share_no_law(plant):
    """A truth plant reaches no other one, nor the equations of the robot that are judged with it."""
    others = {path.name for path in PLANTS.iterdir() if (path / "truth.py").exists()} - {plant}
    for path in sorted((PLANTS / plant).rglob("*.py")):
        below = reached(path)
        used = {name for name in below if name.startswith(tuple(f"sher3_challenge.plants.{o}." for o in others))}
        assert not used, f"{path.relative_to(ROOT)} reaches {sorted(used)}"


def test_the_doors_are_looked_for_where_they_are():
    """The test above must be able to fail: the libraries are imported somewhere, also inside functions."""
    for module in ("rclpy", "can", "canopen"):
        assert any(module in imports(path) for path in FILES), module


LOOSE_FILES = 15
"""Python files in one folder that a reader takes in at a glance; `__init__.py` is not counted."""


def circles(arrows: dict[str, set[str]]) -> list[list[str]]:
    """Return the groups of names that reach each other along the arrows, each sorted."""
    reach = {name: set(targets) for name, targets in arrows.items()}
    for middle in reach:
        for name in reach:
            if middle in reach[name]:
                reach[name] |= reach[middle]
    groups = {tuple(sorted(b for b in reach[a] if a in reach.get(b, ()))) for a in reach if a in reach[a]}
    return [list(group) for group in sorted(groups)]


def test_circles_are_found():
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"b"}, "d": {"a"}}) == [["b", "c"]]
    assert circles({"a": {"b", "c"}, "b": {"c"}, "c": set()}) == []


def test_packages_import_in_no_circle():
    arrows = {
        package: {
            name
            for path in FILES
            if package_of(path) == package
            for name in imports(path)
            if name.startswith("sher3_") and name != package
        }
        for package in PACKAGES
    }
    assert not circles(arrows)


@pytest.mark.parametrize("package", PACKAGES)
def test_the_folders_of_a_package_import_in_no_circle(package):
    """A folder is one room here, and so is each loose file; the face of the package may name them all."""
    arrows: dict[str, set[str]] = {}
    for path in FILES:
        if package_of(path) == package and room_of(path) != "__init__":
            arrows.setdefault(room_of(path), set()).update(rooms_imported(path) - {room_of(path)})
    assert not circles(arrows)


@pytest.mark.parametrize("package", PACKAGES)
def test_the_files_of_a_package_import_in_no_circle(package):
    """Not even for a type, and not inside a function; faces (`__init__`) may name all below them."""
    own = {name: path for name, path in FILE_OF.items() if package_of(path) == package and path.name != "__init__.py"}
    assert not circles({name: (modules(path, types=True) & set(own)) - {name} for name, path in own.items()})


@pytest.mark.parametrize(("one", "other"), [("axes", "manipulator"), ("manipulator", "axes")])
def test_axes_and_arms_do_not_know_each_other(one, other):
    """What both need of a joint stands below them, once."""
    files = [path for path in FILES if package_of(path) == "sher3_chain" and room_of(path) == one]
    assert len(files) > 10
    assert not [path.name for path in files if other in rooms_imported(path)]


def room_of(path: Path) -> str:
    """Return the folder of a package in which a file lies, or the file's own name when it lies in none."""
    return path.relative_to(SOURCES / package_of(path)).with_suffix("").parts[1]


def rooms_imported(path: Path) -> set[str]:
    """Return the rooms of its own package that a file imports."""
    package = package_of(path)
    home = SOURCES / package / package
    words = [module.split(".") for module in modules(path)]
    inside = [word[1] for word in words if word[0] == package and len(word) > 1]
    return {room for room in inside if (home / room).is_dir() or (home / f"{room}.py").is_file()}


def test_no_folder_holds_many_loose_files():
    counts = Counter(path.parent for path in FILES if path.name != "__init__.py")
    assert not {str(folder): count for folder, count in counts.items() if count > LOOSE_FILES}


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
