"""Every dependency of the base has a wheel for each platform and Python that the README names; told offline."""

from __future__ import annotations

import sys

import pytest
from packaging.utils import canonicalize_name, parse_wheel_filename
from sources import ROOT

sys.path.append(str(ROOT / "tools"))

import wheel_table

NAMES = (ROOT / "tools" / "wheels.txt").read_text().split()
WHEELS = [parse_wheel_filename(name) for name in NAMES]


@pytest.mark.parametrize("python", wheel_table.PYTHONS)
@pytest.mark.parametrize("platform", wheel_table.PLATFORMS)
def test_every_dependency_of_the_base_has_a_wheel(platform, python):
    """What the lock pins for them, against the table that `tools/wheel_table.py` wrote."""
    wanted, taken = wheel_table.base(platform, python), wheel_table.taken(platform, python)
    known = {(canonicalize_name(name), str(version)) for name, version, _, tags in WHEELS if tags & taken}
    missing = {f"{name}=={version}" for name, version in wanted.items()} - {f"{n}=={v}" for n, v in known}
    assert not missing, f"run python tools/wheel_table.py > tools/wheels.txt, or change the lock: {sorted(missing)}"
    assert len(wanted) > 30


def test_the_table_holds_nothing_that_the_lock_has_not():
    pinned = {canonicalize_name(p.name): set() for p in wheel_table.pins()}
    for pin in wheel_table.pins():
        pinned[canonicalize_name(pin.name)].add(next(iter(pin.specifier)).version)
    old = [f"{name}=={version}" for name, version, _, _ in WHEELS if str(version) not in pinned.get(name, ())]
    assert not old, f"run python tools/wheel_table.py > tools/wheels.txt: {old}"


def test_no_package_of_ros_is_in_the_base():
    everything = {n for platform in wheel_table.PLATFORMS for n in wheel_table.base(platform, "3.12")}
    assert not [name for name in everything if name.startswith("ros-")]
