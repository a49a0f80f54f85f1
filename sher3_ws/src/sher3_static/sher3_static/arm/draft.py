"""An arm in measured postures drafted from a table without a clock: a column for each joint, and x, y, z of a point.

Columns are joints of the model by their names, or by their numbers where there are as many as joints that move. The
chain runs from the link that carries the first recorded joint to the one that the last moves.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from sher3_machines.drafting.draft import name_of, unused_columns, written
from sher3_machines.drafting.guesses import position_unit
from sher3_machines.drafting.names import bare_and_unit, tells_time
from sher3_machines.intake.kind import Draft
from sher3_machines.intake.spelling import bare
from sher3_machines.intake.tables import Tables
from sher3_machines.urdf import read_urdf

from sher3_static.arm.urdf import SLIDES, TURNS

PLACE = re.compile(r"(?P<before>.*?)(?P<axis>[xyz])(?P<behind>[_ ]?\d*)", re.IGNORECASE)
"""Name of one of three coordinates: `x1`, `tip_y`, `pos z`."""
ENTRY = re.compile(r"(?P<before>.*?)(?P<row>[0-4])[_ ,]?(?P<column>[0-4])")
"""Name of an entry of a pose as a matrix: `m_03`, `T14`."""
NOISE = 1e-4
"""Noise of a measured position, m, that a draft states until somebody does: that of a good tracker in a hall."""
FEWEST = 2
"""Joints that must be named, so that a table is one of postures."""
NUMBERED = re.compile(r"(?P<stem>.*?[a-z])[_ ]?(?P<number>\d+)", re.IGNORECASE)
"""Name of one of several joints: `q1`, `theta_3`, `joint 6`."""


def draft_postures(path: Path, tables: Tables, model: Path) -> Draft | None:
    """Draft an arm of a table of postures; None where it has a clock, or no columns of joints and of a point.

    Raises:
        MachineError: the model cannot be read.
    """
    columns = {name: x for name, x in tables.items() if x.ndim == 1}
    point = next(iter(points(columns).values()), None)
    clock = any(tells_time(name) and bool((np.diff(x) > 0.0).all()) for name, x in columns.items())
    if point is None or model.suffix.lower() != ".urdf" or clock:
        return None
    root = read_urdf(model).root
    above = {child: (joint, parent) for joint, parent, child in joints_of(root)}
    named = {_plain(bare_and_unit(bare(name))[0]): name for name in columns} | numbered(columns, moving(root))
    chain = [(joint, parent, child) for child, (joint, parent) in above.items() if _plain(joint) in named]
    if len(chain) < FEWEST:
        return None
    depth = {child: _depth(child, above) for _, _, child in chain}
    chain.sort(key=lambda link: depth[link[2]])
    own = [named[_plain(joint)] for joint, _, _ in chain]
    guesses = [
        f"postures: {', '.join(own)} are the joints, {', '.join(point)} the measured point; without a time",
        f"noise of {NOISE:g} m is a placeholder: state that of the instrument",
    ]
    data: dict[str, Any] = {"kind": "arm", "name": name_of(path)}
    slides = {joint.get("name") for joint in root.findall("joint") if joint.get("type") == SLIDES}
    data["joint_positions"] = [
        _column(n, columns, joint in slides) for n, (joint, _, _) in zip(own, chain, strict=True)
    ]
    data["positions"] = [_column(name, columns, True) for name in point]
    data |= {"noise": NOISE, "urdf": str(model.resolve()), "base_link": chain[0][1], "tip_link": chain[-1][2]}
    return written(data, [*guesses, *unused_columns(tables, (*own, *point))])


def points(columns: Mapping[str, Any]) -> dict[tuple[str, str], list[str]]:
    """Return the names of the three coordinates of each point, or of each pose that is written as a matrix (3, 4)."""
    found: dict[tuple[str, str], dict[str, str]] = {}
    matrices: dict[str, dict[tuple[int, int], str]] = {}
    for name in columns:
        known = bare_and_unit(bare(name))[0]
        if match := PLACE.fullmatch(known):
            found.setdefault((match["before"], match["behind"]), {})[match["axis"].lower()] = name
        elif match := ENTRY.fullmatch(known):
            matrices.setdefault(match["before"], {})[int(match["row"]), int(match["column"])] = name
    out = {key: [each[axis] for axis in "xyz"] for key, each in found.items() if len(each) == len("xyz")}
    for before, cells in matrices.items():
        first = min(row for row, _ in cells)
        if all((first + i, first + j) in cells for i in range(3) for j in range(4)):
            out[before, "matrix"] = [cells[first + i, first + 3] for i in range(3)]
    return out


def numbered(columns: Mapping[str, Any], joints: Sequence[str]) -> dict[str, str]:
    """Return plain name of a joint -> column, where as many columns of one name are numbered as joints move."""
    groups: dict[str, list[tuple[int, str]]] = {}
    for name in columns:
        if match := NUMBERED.fullmatch(bare_and_unit(bare(name))[0]):
            groups.setdefault(match["stem"].lower(), []).append((int(match["number"]), name))
    each = next((sorted(group) for group in groups.values() if len(group) == len(joints)), [])
    return {_plain(joint): name for joint, (_, name) in zip(joints, each, strict=False)}


def moving(root: ElementTree.Element) -> list[str]:
    """Return the names of the joints of a URDF that move, from the root outwards."""
    above = {child: (joint, parent) for joint, parent, child in joints_of(root)}
    kinds = {joint.get("name", ""): joint.get("type", "") for joint in root.findall("joint")}
    found = [(_depth(child, above), joint) for child, (joint, _) in above.items() if kinds[joint] in (*TURNS, SLIDES)]
    return [joint for _, joint in sorted(found, key=lambda each: each[0])]


def joints_of(root: ElementTree.Element) -> list[tuple[str, str, str]]:
    """Return joint, parent and child link of every joint of a URDF that has them."""
    ends = [(joint.get("name", ""), joint.find("parent"), joint.find("child")) for joint in root.findall("joint")]
    return [(name, a.get("link", ""), b.get("link", "")) for name, a, b in ends if a is not None and b is not None]


def _depth(link: str, above: Mapping[str, tuple[str, str]]) -> int:
    """Return how many joints lie between a link and the root; a circle ends the count."""
    seen: list[str] = []
    while link in above and link not in seen:
        seen.append(link)
        link = above[link][1]
    return len(seen)


def _column(name: str, columns: Mapping[str, Any], slides: bool) -> dict[str, Any]:
    return {"column": name, "unit": position_unit(bare_and_unit(bare(name))[1], columns[name], slides)[0]}


def _plain(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.lower())
