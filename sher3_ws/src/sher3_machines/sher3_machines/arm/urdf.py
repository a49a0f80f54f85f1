"""The chain of revolute joints between two links of a URDF file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from scipy.spatial.transform import Rotation
from sher3_common import FileError, read_text
from sher3_diagnosis.channel import Array

from sher3_machines.arm.kinematics import Arm, transform
from sher3_machines.errors import MachineError

MAX_BYTES = 4_000_000
"""Largest file that is read."""
DEFAULT_AXIS = "1 0 0"
"""Axis of a joint that states none, as the format has it."""


def arm_from_urdf(path: Path, base: str, tip: str) -> Arm:
    """Read the chain between two links.

    Raises:
        MachineError: the file cannot be read, has no such chain, or a joint of it is neither revolute nor fixed.
    """
    names, fixed, axes, pending = [], [], [], np.eye(4)
    for joint in _chain(_root(path), path, base, tip):
        pending = pending @ _origin(joint)
        kind = joint.attrib["type"]
        if kind in ("revolute", "continuous"):
            names.append(joint.attrib["name"])
            fixed.append(pending)
            axes.append(_axis(joint))
            pending = np.eye(4)
        elif kind != "fixed":
            raise MachineError(
                f"{path}: joint {joint.attrib['name']} is not revolute", value=kind, remedy="use a DH table"
            )
    return Arm(tuple(names), np.array(fixed), np.array(axes), pending)


def _root(path: Path) -> ElementTree.Element:
    try:
        text = read_text(path, MAX_BYTES)
        if "<!DOCTYPE" in text:  # what declares entities can expand without bound or name other files
            raise MachineError(f"{path}: has a document type", value="<!DOCTYPE", remedy="give a plain URDF file")
        return ElementTree.fromstring(text)
    except (FileError, ElementTree.ParseError) as error:
        raise MachineError(f"{path}: cannot be read", value=str(error), remedy="give a URDF file") from error


def _chain(root: ElementTree.Element, path: Path, base: str, tip: str) -> Sequence[ElementTree.Element]:
    """Joints from the base to the tip."""
    above = {child.attrib["link"]: j for j in root.iter("joint") if (child := j.find("child")) is not None}
    chain, link = [], tip
    while link != base:
        parent = above[link].find("parent") if link in above else None
        if parent is None or above[link] in chain:
            links = ", ".join(x.attrib["name"] for x in root.iter("link"))
            raise MachineError(
                f"{path}: no chain from {base!r} to {tip!r}", value=link, limit=links, remedy="name its links"
            )
        chain.append(above[link])
        link = parent.attrib["link"]
    return chain[::-1]


def _axis(joint: ElementTree.Element) -> Array:
    """Unit vector of a joint's axis in its frame, (3,)."""
    axis = joint.find("axis")
    u = np.array([float(x) for x in (DEFAULT_AXIS if axis is None else axis.attrib["xyz"]).split()])
    return u / np.linalg.norm(u)


def _origin(joint: ElementTree.Element) -> Array:
    """Transform (4, 4) from the parent link to a joint's frame."""
    origin = joint.find("origin")
    if origin is None:
        return np.eye(4)
    xyz, rpy = ([float(x) for x in origin.attrib.get(k, "0 0 0").split()] for k in ("xyz", "rpy"))
    return transform(xyz, Rotation.from_euler("xyz", rpy).as_matrix())
