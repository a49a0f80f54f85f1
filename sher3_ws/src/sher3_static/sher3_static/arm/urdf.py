"""The chain of revolute joints between two links of a URDF file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
from sher3_machines.errors import MachineError
from sher3_machines.urdf import Urdf, read_urdf

from sher3_static.arm.kinematics import Arm, transform

SLIDES = (
    "take postures in which it stayed, and begin the chain behind it (`base_link`) or end it before it (`tip_link`)"
)
"""What helps where a joint of the chain slides: the errors that are looked for are those of joints that turn."""


def arm_from_urdf(path: Path, base: str, tip: str) -> Arm:
    """Read the chain between two links.

    Raises:
        MachineError: the file cannot be read, has no such chain, or a joint of it is neither revolute nor fixed; an
            attribute is missing or does not hold three numbers.
    """
    urdf = read_urdf(path)
    names, fixed, axes, pending = [], [], [], np.eye(4)
    for joint in _chain(urdf, base, tip):
        turn, place = urdf.pose(joint)
        pending = pending @ transform(place, turn)
        kind, name = urdf.word(joint, "type"), urdf.word(joint, "name")
        if kind in ("revolute", "continuous"):
            names.append(name)
            fixed.append(pending)
            axes.append(urdf.axis(joint))
            pending = np.eye(4)
        elif kind != "fixed":
            raise MachineError(f"{path}: joint {name} is not revolute", value=kind, remedy=SLIDES)
    return Arm(tuple(names), np.array(fixed), np.array(axes), pending)


def _chain(urdf: Urdf, base: str, tip: str) -> Sequence[Element]:
    """Joints from the base to the tip."""
    above = {urdf.word(child, "link"): j for j in urdf.root.iter("joint") if (child := j.find("child")) is not None}
    chain, link = [], tip
    while link != base:
        parent = above[link].find("parent") if link in above else None
        if parent is None or above[link] in chain:
            links = ", ".join(x.attrib.get("name", "?") for x in urdf.root.iter("link"))
            raise urdf.error(f"no chain from {base!r} to {tip!r}", link, links, "name its links")
        chain.append(above[link])
        link = urdf.word(parent, "link")
    return chain[::-1]
