"""The tree of rigid bodies of a URDF: joints in the order of the file, each behind its parent."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from xml.etree.ElementTree import Element

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_machines.errors import MachineError
from sher3_machines.urdf import Urdf, urdf_of

from sher3_chain.manipulator.rigid.tree import WORLD, Gear, Link, Tree, moved, parameters

GRAVITY = (0.0, 0.0, -9.81)
"""Of a URDF, which states none: what simulators and Pinocchio take, m/s^2."""
TURNING, SLIDING, FIXED = ("revolute", "continuous"), ("prismatic",), ("fixed",)
FREELY = (-np.inf, np.inf)
"""Range of a joint without stops."""
MACRO = "xacro:"
"""What an unexpanded file of macros holds."""


def tree_from_urdf(text: str, label: str) -> Tree:
    """Return the bodies and joints of a URDF.

    Args:
        text: of the file.
        label: that errors name.

    Raises:
        MachineError: it is no URDF, or its links are no tree.
    """
    urdf = urdf_of(text, label)
    if urdf.root.tag != "robot":
        raise urdf.error("cannot be read", f"<{urdf.root.tag}>", "<robot>", "give a URDF or MJCF file")
    if MACRO in text and any(element.tag.startswith("{") for element in urdf.root.iter()):
        raise MachineError(f"{label}: holds macros", value=MACRO, remedy="expand it: xacro robot.xacro > robot.urdf")
    return _Reader(urdf).tree()


@dataclass
class _Carrier:
    """Where a URDF link is: behind a joint by number, at a pose in that joint's frame."""

    joint: int
    turn: Array
    place: Array


class _Reader:
    """Walks from the root link outwards."""

    def __init__(self, urdf: Urdf) -> None:
        self._urdf, self._error = urdf, urdf.error
        self._bodies = {urdf.word(x, "name"): x for x in urdf.root.findall("link")}
        self._below: dict[str, list[Element]] = {}
        moved_by: set[str] = set()
        self._joints = urdf.root.findall("joint")
        for joint in self._joints:
            parent, child = (self._end(joint, which) for which in ("parent", "child"))
            if child in moved_by:
                raise self._error(f"link {child} has two parents", child, "one parent", "take a joint out: no loops")
            moved_by.add(child)
            self._below.setdefault(parent, []).append(joint)
        self._roots = [name for name in self._bodies if name not in moved_by]
        self._links: list[Link] = []
        self._other: dict[str, str] = {}

    def tree(self) -> Tree:
        """Return the tree; raises MachineError where the links are not one tree."""
        if len(self._roots) != 1:
            value = ", ".join(self._roots) or "none"
            raise self._error("needs one link that no joint moves", value, "one", "join its links to one tree")
        seen = sum(1 for _ in self._walk(self._roots[0], _Carrier(WORLD, np.eye(3), np.zeros(3))))
        if seen != len(self._bodies):
            raise self._error("joints form a loop", f"{seen} links reached", f"{len(self._bodies)}", "open the loop")
        return Tree(tuple(self._links), np.array(GRAVITY), self._other)

    def _walk(self, name: str, at: _Carrier) -> Iterator[str]:
        """Pass through all links, the first child of each before its next; a joint is counted as it is passed."""
        waiting = [(joint, at) for joint in reversed(self._below.get(name, []))]
        yield name
        while waiting:
            joint, before = waiting.pop()
            name, at = self._end(joint, "child"), self._placed(joint, before)
            if at.joint != WORLD:
                inertia = self._inertial(self._bodies[name].find("inertial"))
                self._links[at.joint] = self._links[at.joint].carrying(inertia, at.turn, at.place, name)
            waiting += [(further, at) for further in reversed(self._below.get(name, []))]
            yield name

    def _placed(self, joint: Element, at: _Carrier) -> _Carrier:
        """Add a joint that moves, and return where its child is."""
        name, kind = self._urdf.word(joint, "name"), self._urdf.word(joint, "type")
        turn, place = self._urdf.pose(joint)
        turn, place = at.turn @ turn, at.place + at.turn @ place
        if kind not in (*TURNING, *SLIDING):
            if kind not in FIXED:
                self._other[name] = kind
            return _Carrier(at.joint, turn, place)
        slides, (low, high) = kind in SLIDING, FREELY if kind == "continuous" else self._range(joint)
        link = Link(name, "", at.joint, turn, place, self._urdf.axis(joint), slides, low=low, high=high)
        self._links.append(replace(link, gear=self._gear(joint)))
        return _Carrier(len(self._links) - 1, np.eye(3), np.zeros(3))

    def _gear(self, joint: Element) -> Gear | None:
        """Return how a joint mimics another."""
        mimic = joint.find("mimic")
        if mimic is None:
            return None
        ratio, offset = (self._urdf.numbers(mimic, k, 1, d)[0] for k, d in (("multiplier", "1"), ("offset", "0")))
        return Gear(self._urdf.word(mimic, "joint"), float(ratio), float(offset))

    def _range(self, joint: Element) -> tuple[float, float]:
        """Return the positions that a joint allows, infinite where it states no limits."""
        limit = joint.find("limit")
        if limit is None or not {"lower", "upper"} <= limit.attrib.keys():
            return FREELY
        low, high = (float(self._urdf.numbers(limit, key, 1)[0]) for key in ("lower", "upper"))
        return (low, high) if low < high else FREELY

    def _inertial(self, element: Element | None) -> Array:
        if element is None:
            return np.zeros(10)
        turn, centre = self._urdf.pose(element)
        mass, inertia = element.find("mass"), element.find("inertia")
        kilograms = 0.0 if mass is None else self._urdf.numbers(mass, "value", 1)[0]
        about = np.zeros((3, 3)) if inertia is None else self._matrix(inertia)
        return moved(parameters(kilograms, np.zeros(3), about), turn, centre)

    def _matrix(self, element: Element) -> Array:
        keys = (("ixx", "ixy", "ixz"), ("ixy", "iyy", "iyz"), ("ixz", "iyz", "izz"))
        return np.array([[self._urdf.numbers(element, k, 1, "0")[0] for k in row] for row in keys])

    def _end(self, joint: Element, which: str) -> str:
        """Return the link before (`parent`) or behind (`child`) a joint."""
        element = joint.find(which)
        name = joint.attrib.get("name", "?")
        if element is None:
            raise self._error(f"joint {name} has no <{which}>", "none", "one", "correct the file")
        link = self._urdf.word(element, "link")
        if link not in self._bodies:
            raise self._error(f"joint {name} names a link that is not there", link, "a link of the file", "correct it")
        return link
