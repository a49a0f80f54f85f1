"""A URDF as text: its words, numbers, poses and axes, with errors that name the file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np
from scipy.spatial.transform import Rotation
from sher3_common import FileError, read_text
from sher3_diagnosis.channel import Array

from sher3_machines.errors import MachineError

MAX_BYTES = 4_000_000
"""Largest file that is read."""
LARGEST, SHORTEST = 1e9, 1e-9
"""Largest number of a file, and shortest axis that has a direction."""
DEFAULT_AXIS = "1 0 0"
"""Axis of a joint that states none, as the format has it."""


@dataclass(frozen=True)
class Urdf:
    """A URDF; every method raises MachineError where the file does not hold what it should.

    Attributes:
        root: its outermost element.
        label: that errors name.
    """

    root: Element
    label: str

    def word(self, element: Element, key: str) -> str:
        """Return an attribute that must be there; raises MachineError where it is not."""
        if key not in element.attrib:
            raise self.error(f"<{element.tag}> has no {key!r}", element.attrib, f"{key}=...", "correct the file")
        return element.attrib[key]

    def numbers(self, element: Element, key: str, count: int, default: str | None = None) -> Array:
        """Return finite numbers (count,) of an attribute, or the format's default; raises MachineError for others."""
        text = self.word(element, key) if default is None else element.attrib.get(key, default)
        try:
            found = np.array([float(word) for word in text.split()])
        except ValueError:
            found = np.empty(0)
        if found.shape != (count,) or not np.all(np.abs(found) <= LARGEST):
            limit = "a number" if count == 1 else f"{count} numbers"
            raise self.error(f"{key} of <{element.tag}>", text, limit, "correct the file")
        return found

    def pose(self, element: Element) -> tuple[Array, Array]:
        """Return rotation (3, 3) and position (3,), m, of the origin of an element in the frame before it."""
        origin = element.find("origin")
        if origin is None:
            return np.eye(3), np.zeros(3)
        xyz, rpy = (self.numbers(origin, key, 3, "0 0 0") for key in ("xyz", "rpy"))
        return Rotation.from_euler("xyz", rpy).as_matrix(), xyz

    def axis(self, joint: Element) -> Array:
        """Return the axis of a joint in its frame, a unit vector (3,); raises MachineError where it has no length."""
        element = joint.find("axis")
        found = self.numbers(Element("axis") if element is None else element, "xyz", 3, DEFAULT_AXIS)
        length = float(np.linalg.norm(found))
        if length < SHORTEST:
            name, value = self.word(joint, "name"), found.tolist()
            raise self.error(f"axis of joint {name}", value, "not zero", "give its direction")
        return found / length

    def error(self, what: str, value: object, limit: str, remedy: str) -> MachineError:
        """Return an error that names the file."""
        return MachineError(f"{self.label}: {what}", value=value, limit=limit, remedy=remedy)


def urdf_of(text: str, label: str) -> Urdf:
    """Return the URDF of a text; raises MachineError where it is no XML, or declares entities."""
    if "<!DOCTYPE" in text:  # what declares entities can expand without bound or name other files
        raise MachineError(f"{label}: has a document type", value="<!DOCTYPE", remedy="give a plain URDF file")
    try:
        return Urdf(ElementTree.fromstring(text.lstrip()), label)  # a template may leave a blank line
    except ElementTree.ParseError as error:
        raise MachineError(f"{label}: cannot be read", value=str(error), remedy="give a URDF or MJCF file") from error


def read_urdf(path: Path) -> Urdf:
    """Return the URDF of a file; raises MachineError where it cannot be read."""
    try:
        return urdf_of(read_text(path, MAX_BYTES), str(path))
    except FileError as error:
        raise MachineError(error.what, value=error.value, limit=error.limit, remedy=error.remedy) from error
