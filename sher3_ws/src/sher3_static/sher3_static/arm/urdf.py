"""The chain of revolute joints between two links of a URDF file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from scipy.spatial.transform import Rotation
from sher3_common import FileError, read_text
from sher3_diagnosis.channel import Array
from sher3_machines.errors import MachineError

from sher3_static.arm.kinematics import Arm, transform

MAX_BYTES = 4_000_000
"""Largest file that is read."""
LARGEST, SHORTEST = 1e6, 1e-9
"""Largest number of a file [m, rad], and shortest axis that has a direction."""
SLIDES = (
    "take postures in which it stayed, and begin the chain behind it (`base_link`) or end it before it (`tip_link`)"
)
"""What helps where a joint of the chain slides: the errors that are looked for are those of joints that turn."""
DEFAULT_AXIS = "1 0 0"
"""Axis of a joint that states none, as the format has it."""


def arm_from_urdf(path: Path, base: str, tip: str) -> Arm:
    """Read the chain between two links.

    Raises:
        MachineError: the file cannot be read, has no such chain, or a joint of it is neither revolute nor fixed; an
            attribute is missing or does not hold three numbers.
    """
    names, fixed, axes, pending = [], [], [], np.eye(4)
    for joint in _chain(read_urdf(path), path, base, tip):
        pending = pending @ _origin(joint, path)
        kind, name = _word(joint, "type", path), _word(joint, "name", path)
        if kind in ("revolute", "continuous"):
            names.append(name)
            fixed.append(pending)
            axes.append(_axis(joint, path))
            pending = np.eye(4)
        elif kind != "fixed":
            raise MachineError(f"{path}: joint {name} is not revolute", value=kind, remedy=SLIDES)
    return Arm(tuple(names), np.array(fixed), np.array(axes), pending)


def read_urdf(path: Path) -> ElementTree.Element:
    """Return the root of a URDF file; raises MachineError where it cannot be read."""
    try:
        text = read_text(path, MAX_BYTES)
        if "<!DOCTYPE" in text:  # what declares entities can expand without bound or name other files
            raise MachineError(f"{path}: has a document type", value="<!DOCTYPE", remedy="give a plain URDF file")
        return ElementTree.fromstring(text)
    except (FileError, ElementTree.ParseError) as error:
        raise MachineError(f"{path}: cannot be read", value=str(error), remedy="give a URDF file") from error


def _chain(root: ElementTree.Element, path: Path, base: str, tip: str) -> Sequence[ElementTree.Element]:
    """Joints from the base to the tip."""
    above = {_word(child, "link", path): j for j in root.iter("joint") if (child := j.find("child")) is not None}
    chain, link = [], tip
    while link != base:
        parent = above[link].find("parent") if link in above else None
        if parent is None or above[link] in chain:
            links = ", ".join(x.attrib.get("name", "?") for x in root.iter("link"))
            raise MachineError(
                f"{path}: no chain from {base!r} to {tip!r}", value=link, limit=links, remedy="name its links"
            )
        chain.append(above[link])
        link = _word(parent, "link", path)
    return chain[::-1]


def _word(element: ElementTree.Element, name: str, path: Path) -> str:
    """Return an attribute that must be there."""
    if name not in element.attrib:
        raise MachineError(f"{path}: <{element.tag}> has no {name!r}", value=element.attrib, remedy="correct the file")
    return element.attrib[name]


def _three(text: str, path: Path, what: str) -> Array:
    """Return three finite numbers of a text, (3,)."""
    try:
        numbers = np.array([float(word) for word in text.split()])
    except ValueError:
        numbers = np.empty(0)
    if numbers.shape != (3,) or not np.all(np.abs(numbers) <= LARGEST):
        raise MachineError(f"{path}: {what}", value=text, limit="three numbers", remedy="correct the file")
    return numbers


def _axis(joint: ElementTree.Element, path: Path) -> Array:
    """Unit vector of a joint's axis in its frame, (3,)."""
    axis = joint.find("axis")
    text = DEFAULT_AXIS if axis is None else _word(axis, "xyz", path)
    u = _three(text, path, "axis of a joint")
    length = float(np.linalg.norm(u))
    if length < SHORTEST:
        raise MachineError(f"{path}: axis of a joint", value=text, limit="not zero", remedy="give its direction")
    return u / length


def _origin(joint: ElementTree.Element, path: Path) -> Array:
    """Transform (4, 4) from the parent link to a joint's frame."""
    origin = joint.find("origin")
    if origin is None:
        return np.eye(4)
    xyz, rpy = (_three(origin.attrib.get(k, "0 0 0"), path, f"{k} of an origin") for k in ("xyz", "rpy"))
    return transform(xyz.tolist(), Rotation.from_euler("xyz", rpy).as_matrix())
