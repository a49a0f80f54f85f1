"""The chain of joints between two links of a URDF file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np
from sher3_machines.errors import MachineError
from sher3_machines.urdf import Urdf, read_urdf

from sher3_static.arm.kinematics import Arm, transform

TURNS, SLIDES = ("revolute", "continuous"), "prismatic"
"""Types of joint that a posture has a value of."""


def arm_from_urdf(path: Path, base: str, tip: str) -> Arm:
    """Read the chain between two links.

    Raises:
        MachineError: the file cannot be read, has no such chain, or a joint neither turns nor slides nor is fixed; an
            attribute is missing or does not hold three numbers.
    """
    urdf = read_urdf(path)
    names, slides, fixed, axes, pending = [], [], [], [], np.eye(4)
    for joint in _chain(urdf, base, tip):
        turn, place = urdf.pose(joint)
        pending = pending @ transform(place, turn)
        kind, name = urdf.word(joint, "type"), urdf.word(joint, "name")
        if kind in (*TURNS, SLIDES):
            names.append(name)
            slides += [name] if kind == SLIDES else []
            fixed.append(pending)
            axes.append(urdf.axis(joint))
            pending = np.eye(4)
        elif kind != "fixed":
            remedy = "begin the chain behind it (`base_link`) or end it before it (`tip_link`)"
            raise MachineError(f"{path}: joint {name} neither turns nor slides", value=kind, remedy=remedy)
    return Arm(tuple(names), np.array(fixed), np.array(axes), pending, tuple(slides))


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
