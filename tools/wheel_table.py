"""Which wheels the base installs by: a table of file names for every platform and Python that the README names.

    python tools/wheel_table.py > tools/wheels.txt

asks pip for each pinned dependency of the base, once for each platform and Python, and downloads nothing. The table is
checked offline (`tests/test_wheels_of_the_base.py`); run this again after `tools/lock`.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from importlib.metadata import PackageNotFoundError, requires
from pathlib import Path

from packaging.requirements import Requirement
from packaging.tags import Tag, compatible_tags, cpython_tags, mac_platforms
from packaging.utils import canonicalize_name

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).resolve().parents[1]
PYTHONS = ("3.10", "3.11", "3.12", "3.13")
GLIBC = range(28, 4, -1)
"""Minor versions of glibc 2 whose wheels an Ubuntu 20.04 or later, or a Debian 10, takes."""
MAC = (14, 0)
"""Release of macOS that is asked for."""


def linux(machine: str) -> list[str]:
    """Return the platforms of wheels that a Linux of glibc 2.28 takes, best first."""
    old = {17: "manylinux2014", 12: "manylinux2010", 5: "manylinux1"}
    names = [[f"manylinux_2_{minor}", *([old[minor]] if minor in old else [])] for minor in GLIBC]
    return [f"{name}_{machine}" for pair in names for name in pair]


PLATFORMS = {
    "linux-x86_64": linux("x86_64"),
    "linux-aarch64": linux("aarch64"),
    "macos-arm64": list(mac_platforms(MAC, "arm64")),
}
"""Platform -> those of wheels that it takes, best first."""


def environment(platform: str, python: str) -> dict[str, str]:
    """Return what markers of dependencies are read with."""
    mac = platform.startswith("macos")
    return {
        "python_version": python,
        "python_full_version": f"{python}.0",
        "implementation_name": "cpython",
        "platform_python_implementation": "CPython",
        "os_name": "posix",
        "sys_platform": "darwin" if mac else "linux",
        "platform_system": "Darwin" if mac else "Linux",
        "platform_machine": platform.split("-")[1],
        "extra": "",
    }


def pins() -> list[Requirement]:
    """Return what the lock pins, with its markers."""
    text = (ROOT / "requirements.txt").read_text()
    return [Requirement(line.rstrip(" \\")) for line in text.splitlines() if re.match(r"\w", line)]


def base(platform: str, python: str) -> dict[str, str]:
    """Return name -> pinned version of everything that the base needs, read from the packages that are installed."""
    known = environment(platform, python)
    versions = {
        canonicalize_name(p.name): next(iter(p.specifier)).version
        for p in pins()
        if p.marker is None or p.marker.evaluate(known)
    }
    found: dict[str, str] = {}
    left = [Requirement(x) for x in tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["dependencies"]]
    while left:
        wanted = left.pop()
        name = canonicalize_name(wanted.name)
        if name in versions and name not in found:  # what the lock has not is needed by other versions alone
            found[name] = versions[name]
            left += _needs(name, known, wanted.extras)
    return found


def _needs(name: str, known: dict[str, str], extras: set[str]) -> list[Requirement]:
    """Return what a package needs; nothing of one that is needed elsewhere alone, as tomli is below Python 3.11."""
    try:
        wanted = [Requirement(x) for x in requires(name) or []]
    except PackageNotFoundError:
        return []
    asked = [{**known, "extra": extra} for extra in ("", *extras)]
    return [one for one in wanted if one.marker is None or any(one.marker.evaluate(x) for x in asked)]


def taken(platform: str, python: str) -> set[Tag]:
    """Return the tags of wheels that a platform and a Python take."""
    version = tuple(int(x) for x in python.split("."))
    names = PLATFORMS[platform]
    interpreter = f"cp{python.replace('.', '')}"
    return {*cpython_tags(version, platforms=names), *compatible_tags(version, interpreter, names)}


def wheels(platform: str, python: str) -> Iterator[str]:
    """Return the file name of the wheel of each package, as pip would take it."""
    wanted = [f"{name}=={version}" for name, version in base(platform, python).items()]
    with tempfile.TemporaryDirectory() as folder:
        options = ["--dry-run", "--quiet", "--ignore-installed", "--no-deps", "--only-binary", ":all:"]
        options += ["--target", folder, "--python-version", python, "--report", f"{folder}/report.json"]
        options += [word for name in PLATFORMS[platform] for word in ("--platform", name)]
        subprocess.run([sys.executable, "-m", "pip", "install", *options, *wanted], check=True, stdout=sys.stderr)
        report = json.loads(Path(folder, "report.json").read_text())
    for item in report["install"]:
        yield item["download_info"]["url"].rpartition("/")[2].partition("#")[0]


if __name__ == "__main__":
    print("\n".join(sorted({w for platform in PLATFORMS for python in PYTHONS for w in wheels(platform, python)})))
