"""URDF: friction, damping and limit of a joint, and the place of its zero."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from scipy.spatial.transform import Rotation
from sher3_effects.page import NOISE

from sher3_export.changes import Change
from sher3_export.targets.links import INERTIAL, WANTED, Inertia, WrongLinks
from sher3_export.targets.target import NOT_GIVEN, Row, XmlTarget, each, field
from sher3_export.xml_file import add, number, numbers, written

PAYLOAD = "a payload is a link of its own: add it with a fixed joint by hand, or export to mjcf"
ELASTIC = "a URDF joint has no play and no spring; add a joint by hand or export to mjcf"


class Urdf(XmlTarget):
    """A robot of the Unified Robot Description Format."""

    name, root_tag = "urdf", "robot"
    suffix = "urdf"
    refuses: ClassVar[Mapping[str, str]] = {
        **NOT_GIVEN,
        **each(
            {
                "static": "URDF friction is the same at rest and in motion; only the sliding level was written",
                "stribeck": "URDF friction does not depend on speed",
                "offset": "a URDF joint has no constant force",
                "weight": "a share of the weight without its inertia is no mass of a link",
                "inertia": "a URDF joint has no rotor inertia, and that of a link would move every joint before it",
                "drive delay lag servo servo_position servo_velocity servo_delay": "a URDF has no drive: no gain, "
                "delay or lag",
                "cogging cogging_periods cogging_phase": "a URDF joint has no force over its angle",
                "backlash compliance": ELASTIC,
                "payload payload_x payload_y payload_z": PAYLOAD,
                "spring rest": ELASTIC,
                " ".join(NOISE): "a URDF has no sensor of a joint; --to ros2_control has its interfaces",
            }
        ),
    }

    def __init__(self, root: Element) -> None:
        super().__init__(root)
        self.links = WrongLinks(root)

    def text(self, remarks: Sequence[str]) -> str:
        """Return the model with remarks as a comment on top, and its links changed together."""
        links = {x.get("name"): x for x in self.root.findall("link")}
        for name, body in self.links.changed().items():
            set_inertial(links[name], body)
        return super().text([*remarks, *self.links.remarks()])

    def all_joints(self) -> Sequence[Element]:
        """Return the joints that move."""
        return [x for x in self.root.findall("joint") if x.get("type") != "fixed"]

    def place(self, change: Change) -> Element | None:
        """Return the joint of a change, or the link that is heavier."""
        links = {x.get("name"): x for x in self.root.findall("link")}
        return links.get(change.joint) if change.constant.startswith("link") else super().place(change)

    def nominal(self) -> dict[str, dict[str, float]]:
        """Return friction and damping of joints; a URDF knows no rotor."""
        said = {name: joint.find("dynamics") for name, joint in self.joints.items()}
        return {
            name: {c: 0.0 if x is None else number(x.get(self.fields[c])) for c in ("coulomb", "viscous")}
            for name, x in said.items()
        }

    def _link(self, change: Change, link: Element) -> str:
        """A link is one with all that fixed joints hold to it; mass and inertia of each keep their centre."""
        for part in self._together(link):
            for values in (*part.findall("inertial/mass"), *part.findall("inertial/inertia")):
                for name, value in list(values.attrib.items()):
                    values.set(name, written((1.0 + change.value) * number(value)))
        return ""

    def _together(self, link: Element) -> list[Element]:
        """Return a link and those that fixed joints hold to it."""
        links = {x.get("name"): x for x in self.root.findall("link")}
        fixed = [x for x in self.root.findall("joint") if x.get("type") == "fixed"]
        below = [child(x, "child").get("link") for x in fixed if child(x, "parent").get("link") == link.get("name")]
        return [link, *(part for name in below if name in links for part in self._together(links[name]))]

    def _dynamics(self, joint: Element, attribute: str, change: float) -> str:
        add(child(joint, "dynamics"), attribute, change)
        return ""

    def _zero(self, change: Change, joint: Element) -> str:
        """The reading is larger by the offset: the joint frame turns, or moves, back by as much about its axis."""
        origin, axis = child(joint, "origin"), joint.find("axis")
        along = np.array(numbers(None if axis is None else axis.get("xyz"), "1 0 0"))
        along = along / np.linalg.norm(along)
        turn = Rotation.from_euler("xyz", numbers(origin.get("rpy"), "0 0 0"))
        if joint.get("type") == "prismatic":
            return self._move(origin, turn, -change.value * along)
        origin.set("rpy", written(*(turn * Rotation.from_rotvec(-change.value * along)).as_euler("xyz")))
        return ""

    def _shift(self, change: Change, joint: Element) -> str:
        """A joint that sits elsewhere than drawn, along the axes of its own frame."""
        origin = child(joint, "origin")
        turn = Rotation.from_euler("xyz", numbers(origin.get("rpy"), "0 0 0"))
        return self._move(origin, turn, change.value * np.eye(3)["xyz".index(change.constant[-1])])

    def _move(self, origin: Element, turn: Rotation, step: np.ndarray) -> str:
        origin.set("xyz", written(*(np.array(numbers(origin.get("xyz"), "0 0 0")) + turn.apply(step))))
        return ""

    rows: ClassVar[Mapping[str, Row]] = {
        "coulomb": Row("friction", lambda to, change, joint: to._dynamics(joint, "friction", change.value)),
        "viscous": Row("damping", lambda to, change, joint: to._dynamics(joint, "damping", change.value)),
        "limit": Row("effort", lambda to, change, joint: field(child(joint, "limit"), "effort", change.value)),
        "link": Row("mass and inertia", _link),
        **dict.fromkeys(INERTIAL, WANTED),
        "zero": Row("origin", _zero),
        **dict.fromkeys(("shift_x", "shift_y", "shift_z"), Row("origin", _shift)),
    }


def set_inertial(link: Element, body: Inertia) -> None:
    """Give a link mass, centre and inertia."""
    inertial = child(link, "inertial")
    child(inertial, "origin").attrib.update({"xyz": written(*body.centre), "rpy": "0 0 0"})
    child(inertial, "mass").set("value", written(body.mass))
    child(inertial, "inertia").attrib.update({name: written(x) for name, x in body.about.items()})


def child(element: Element, tag: str) -> Element:
    """Return a child element, made where it is missing."""
    found = element.find(tag)
    return SubElement(element, tag) if found is None else found
