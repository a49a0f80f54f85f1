"""The robot as URDF, generated from its parameters, for viewers and rigid-body libraries.

URDF knows trees only. The delta stage therefore appears as three translations of the platform, which is what it does,
beside the three sliders on their rails; the tilt joint is the angle, not the slider. Joint origins and masses come from
the robot file. The file has no inertias about the centres of mass, so bodies are point masses. Their shapes for a
viewer are those of `visuals`; the legs close loops, which no URDF can, and are shown as markers.
"""

from __future__ import annotations

import math
from xml.etree import ElementTree

from sher3_description.robot import Robot
from sher3_description.visuals import Shape, shapes

Triple = tuple[float, float, float]
ZERO: Triple = (0.0, 0.0, 0.0)


def urdf(robot: Robot) -> str:
    """Return the URDF text.

    Movable joints: `delta_1 delta_2 delta_3` (sliders), `platform_x platform_y platform_z`, `roll`, `tilt_angle`.
    Links: `b`, `slider_k`, `p`, `r`, `a`, `t`, `f` and two massless ones inside the platform's translation.
    """
    root = ElementTree.Element("robot", name="sher3")
    _link(root, "b")
    _sliders(root, robot)
    _platform(root, robot)
    _arm(root, robot)
    for name, bodies in shapes(robot).items():
        link = root.find(f"link[@name='{name}']")
        assert link is not None
        for number, body in enumerate(bodies):
            _visual(link, f"{name}_{number}", body)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def tilt_angle_limits(robot: Robot) -> tuple[float, float]:
    """Return the tilt angles [rad] at the ends of the tilt slider's travel (offset slider-crank, closed form)."""
    linkage, limits = robot.tilt_linkage, robot.actuators[4].limits
    r, e, coupler = linkage.crank, linkage.offset, linkage.coupler
    at_zero = math.sqrt(coupler**2 - (e - r) ** 2)
    angles = []
    for travel in (limits.lower, limits.upper):
        x = at_zero + travel
        angles.append(math.atan2(x, e) - math.acos((x**2 + e**2 + r**2 - coupler**2) / (2 * r * math.hypot(x, e))))
    return angles[0], angles[1]


def _sliders(root: ElementTree.Element, robot: Robot) -> None:
    half = robot.delta.leg_width / 2
    radius = math.sqrt(robot.delta.base_radius**2 - half**2)
    for k, azimuth in enumerate(robot.delta.leg_azimuth):
        actuator = robot.actuators[k]
        origin = (radius * math.cos(azimuth), radius * math.sin(azimuth), robot.delta.slider_zero)
        _link(root, f"slider_{k + 1}")
        limits = (actuator.limits.lower, actuator.limits.upper)
        _joint(root, actuator.name, "prismatic", "b", f"slider_{k + 1}", origin, (0, 0, 1), limits, k, robot)


def _platform(root: ElementTree.Element, robot: Robot) -> None:
    """Add the translation of the platform; its limits are the reach, an outer bound of the workspace."""
    reach = robot.delta.link_length - robot.delta.leg_offset
    travel = [actuator.limits for actuator in robot.actuators[:3]]
    height = robot.delta.slider_zero + robot.delta.link_length
    ends = (min(limit.lower for limit in travel), height + max(limit.upper for limit in travel))
    parent = "b"
    for axis, (name, child) in enumerate((("x", "p_x"), ("y", "p_y"), ("z", "p"))):
        _link(root, child, robot.delta.moving_mass if child == "p" else 0.0)
        direction = tuple(float(axis == i) for i in range(3))
        limits = ends if name == "z" else (-reach, reach)
        _joint(root, f"platform_{name}", "prismatic", parent, child, ZERO, direction, limits, 0, robot)
        parent = child


def _arm(root: ElementTree.Element, robot: Robot) -> None:
    arm, roll = robot.arm, robot.actuators[3].limits
    _link(root, "r", arm.roll_mass, arm.roll_com)
    _link(root, "a", arm.tilt_mass, arm.tilt_com)
    _joint(root, "roll", "revolute", "p", "r", (0.0, 0.0, arm.d1), (1, 0, 0), (roll.lower, roll.upper), 3, robot)
    tilt = tilt_angle_limits(robot)
    _joint(root, "tilt_angle", "revolute", "r", "a", (arm.d2, 0.0, arm.d3), (0, 1, 0), tilt, 4, robot)
    _link(root, "t")
    _link(root, "f")
    _joint(root, "tip", "fixed", "a", "t", arm.tool)
    _joint(root, "force_sensor", "fixed", "t", "f", robot.force_sensor.position)


def _link(root: ElementTree.Element, name: str, mass: float = 0.0, com: Triple = ZERO) -> None:
    link = ElementTree.SubElement(root, "link", name=name)
    if mass > 0.0:
        inertial = ElementTree.SubElement(link, "inertial")
        ElementTree.SubElement(inertial, "origin", xyz=_xyz(com))
        ElementTree.SubElement(inertial, "mass", value=repr(mass))
        ElementTree.SubElement(inertial, "inertia", dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), "0.0"))


def _visual(link: ElementTree.Element, name: str, shape: Shape) -> None:
    visual = ElementTree.SubElement(link, "visual")
    ElementTree.SubElement(visual, "origin", xyz=_xyz(shape.origin), rpy=_xyz(shape.rotation))
    geometry = ElementTree.SubElement(visual, "geometry")
    if shape.kind == "box":
        ElementTree.SubElement(geometry, "box", size=_xyz(shape.size))
    elif shape.kind == "cylinder":
        ElementTree.SubElement(geometry, "cylinder", radius=repr(shape.size[0]), length=repr(shape.size[1]))
    else:
        ElementTree.SubElement(geometry, "sphere", radius=repr(shape.size[0]))
    material = ElementTree.SubElement(visual, "material", name=name)
    ElementTree.SubElement(material, "color", rgba=_xyz((*shape.colour, 1.0)))


def _joint(
    root: ElementTree.Element,
    name: str,
    kind: str,
    parent: str,
    child: str,
    origin: Triple,
    axis: tuple[float, ...] | None = None,
    limits: tuple[float, float] | None = None,
    actuator: int = 0,
    robot: Robot | None = None,
) -> None:
    joint = ElementTree.SubElement(root, "joint", name=name, type=kind)
    ElementTree.SubElement(joint, "parent", link=parent)
    ElementTree.SubElement(joint, "child", link=child)
    ElementTree.SubElement(joint, "origin", xyz=_xyz(origin))
    if axis is not None and limits is not None and robot is not None:
        ElementTree.SubElement(joint, "axis", xyz=_xyz(axis))
        values = robot.actuators[actuator]
        ElementTree.SubElement(
            joint,
            "limit",
            lower=repr(limits[0]),
            upper=repr(limits[1]),
            velocity=repr(values.limits.velocity),
            effort=repr(values.drive.limit),
        )


def _xyz(values: tuple[float, ...]) -> str:
    return " ".join(repr(float(value)) for value in values)
