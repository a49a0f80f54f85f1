"""Shapes of the links for viewers: simple bodies whose places follow from the robot file.

What the file does not say is chosen for the picture: the thickness of every part and the posts it stands on.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from sher3_description.robot import Robot

Triple = tuple[float, float, float]
STEEL = (0.72, 0.74, 0.77)
DARK = (0.25, 0.27, 0.31)
BLUE = (0.16, 0.42, 0.75)
RED = (0.85, 0.25, 0.2)


class Shape(NamedTuple):
    """One body of a link.

    Attributes:
        kind: `box` (three edges), `cylinder` (radius, length along z) or `sphere` (radius) [m].
        size: of the body, see `kind`.
        origin: its centre (3,) [m] in the link's frame.
        rotation: roll, pitch, yaw [rad] of the body in the link's frame.
        colour: red, green, blue from 0 to 1.
    """

    kind: str
    size: tuple[float, ...]
    origin: Triple = (0.0, 0.0, 0.0)
    rotation: Triple = (0.0, 0.0, 0.0)
    colour: Triple = STEEL


def shapes(robot: Robot) -> dict[str, list[Shape]]:
    """Return the bodies of every link of the URDF that has any, by its name."""
    lower = min(a.limits.lower for a in robot.actuators[:3]) + robot.delta.slider_zero - 0.02
    upper = max(a.limits.upper for a in robot.actuators[:3]) + robot.delta.slider_zero + 0.02
    out = robot.delta.base_distance + 0.012
    base = [Shape("cylinder", (0.1, 0.006), (0.0, 0.0, lower - 0.003), colour=DARK)]
    found: dict[str, list[Shape]] = {"b": base}
    for k, azimuth in enumerate(robot.delta.leg_azimuth):
        turn = (0.0, 0.0, azimuth)
        middle = (out * math.cos(azimuth), out * math.sin(azimuth), (lower + upper) / 2)
        base.append(Shape("box", (0.008, 0.022, upper - lower), middle, turn, DARK))
        found[f"slider_{k + 1}"] = [Shape("box", (0.01, 0.036, 0.022), rotation=turn, colour=BLUE)]
    return found | _arm(robot)


def _arm(robot: Robot) -> dict[str, list[Shape]]:
    arm, across = robot.arm, math.pi / 2
    tool = math.hypot(*arm.tool)
    pitch = math.atan2(arm.tool[0], arm.tool[2]) if tool else 0.0
    half_way: Triple = (arm.tool[0] / 2, arm.tool[1] / 2, arm.tool[2] / 2)
    return {
        "p": [
            Shape("cylinder", (0.025, 0.006)),
            Shape("cylinder", (0.012, arm.d1), (0.0, 0.0, arm.d1 / 2), colour=DARK),
        ],
        "r": [
            Shape("cylinder", (0.02, 0.058), (-0.005, 0.0, 0.0), (0.0, across, 0.0), DARK),
            Shape("box", (arm.d2, 0.022, 0.014), (arm.d2 / 2, 0.0, arm.d3)),
        ],
        "a": [
            Shape("cylinder", (0.0055, 0.034), rotation=(across, 0.0, 0.0), colour=DARK),
            Shape("cylinder", (0.004, tool), half_way, (0.0, pitch, 0.0)),
        ],
        "f": [Shape("cylinder", (0.0085, 0.015), colour=BLUE)],
        "t": [Shape("sphere", (0.0008,), colour=RED)],
    }
