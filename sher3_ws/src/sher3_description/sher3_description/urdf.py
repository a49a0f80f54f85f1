"""The robot as URDF, generated from its parameters, for viewers and rigid-body libraries.

Its tree is that of `model_joints`; origins and masses come from the robot file. The file has no inertias about the
centres of mass, so bodies are point masses. Their shapes for a viewer are those of `visuals`; the legs close loops,
which no URDF can, and are shown as markers.
"""

from __future__ import annotations

import math
from xml.etree import ElementTree

from sher3_description.equipment import Actuator
from sher3_description.model_joints import ZERO, ModelJoint, Triple, fixed_joints, moving_joints
from sher3_description.robot import Robot
from sher3_description.visuals import Shape, shapes

_NAMES = {"link": ("name",), "joint": ("name",), "parent": ("link",), "child": ("link",)}
"""Attributes that name a link or a joint, by tag."""


def urdf(robot: Robot, prefix: str = "") -> str:
    """Return the URDF text; `prefix` stands before the names of links and joints.

    Movable joints: `delta_1 delta_2 delta_3` (sliders), `platform_x platform_y platform_z`, `roll`, `tilt_angle`.
    Links: `b`, `slider_k`, `p`, `r`, `a`, `t`, `f` and two massless ones inside the platform's translation.
    """
    root = ElementTree.Element("robot", name="sher3")
    masses, travels = _masses(robot), _travels(robot)
    _link(root, "b")
    for joint in (*moving_joints(robot), *fixed_joints(robot)):
        mass, com = masses.get(joint.child, (0.0, ZERO))
        _link(root, joint.child, mass, com)
        _joint(root, joint, travels.get(joint.name))
    for name, bodies in shapes(robot).items():
        link = root.find(f"link[@name='{name}']")
        assert link is not None
        for number, body in enumerate(bodies):
            _visual(link, f"{name}_{number}", body)
    for element in root.iter():
        for key in _NAMES.get(element.tag, ()):
            element.set(key, prefix + element.attrib[key])
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


def _masses(robot: Robot) -> dict[str, tuple[float, Triple]]:
    """Return mass [kg] and its centre (3,) [m] in the link's frame of every link that has any."""
    arm = robot.arm
    return {
        "p": (robot.delta.moving_mass, ZERO),
        "r": (arm.roll_mass, arm.roll_com),
        "a": (arm.tilt_mass, arm.tilt_com),
    }


def _travels(robot: Robot) -> dict[str, tuple[float, float, Actuator]]:
    """Return the ends [m, rad] of every movable joint, and the actuator whose speed and effort limit it.

    The platform's ends are the reach, an outer bound of the workspace.
    """
    sliders, roll, tilt = robot.actuators[:3], robot.actuators[3], robot.actuators[4]
    reach = robot.delta.link_length - robot.delta.leg_offset
    height = robot.delta.slider_zero + robot.delta.link_length
    ends = [(actuator.limits.lower, actuator.limits.upper, actuator) for actuator in (*sliders, roll)]
    lowest, highest = min(end[0] for end in ends[:3]), max(end[1] for end in ends[:3])
    return {actuator.name: (lower, upper, actuator) for lower, upper, actuator in ends} | {
        "platform_x": (-reach, reach, sliders[0]),
        "platform_y": (-reach, reach, sliders[0]),
        "platform_z": (lowest, height + highest, sliders[0]),
        "tilt_angle": (*tilt_angle_limits(robot), tilt),
    }


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


def _joint(root: ElementTree.Element, joint: ModelJoint, travel: tuple[float, float, Actuator] | None) -> None:
    element = ElementTree.SubElement(root, "joint", name=joint.name, type=joint.kind)
    ElementTree.SubElement(element, "parent", link=joint.parent)
    ElementTree.SubElement(element, "child", link=joint.child)
    ElementTree.SubElement(element, "origin", xyz=_xyz(joint.origin))
    if travel is None:
        return
    lower, upper, actuator = travel
    ElementTree.SubElement(element, "axis", xyz=_xyz(joint.axis))
    limits = {"lower": lower, "upper": upper, "velocity": actuator.limits.velocity, "effort": actuator.drive.limit}
    ElementTree.SubElement(element, "limit", {name: repr(value) for name, value in limits.items()})


def _xyz(values: tuple[float, ...]) -> str:
    return " ".join(repr(float(value)) for value in values)
