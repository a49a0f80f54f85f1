"""The nominal model of a chain of axes as MJCF, where the user gives none."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, tostring

from sher3_chain.axes.command.law import is_law
from sher3_chain.axes.evidence import AxisEvidence
from sher3_common import FileError, read_text
from sher3_description.contract import GRAVITY

from sher3_export.check.engine import mujoco
from sher3_export.check.recorded import is_passive
from sher3_export.errors import ExportError
from sher3_export.targets.mjcf.whole import whole
from sher3_export.xml_file import MAX_BYTES, parse_xml, written

SLENDER = 0.5
"""Share of a pendulum's inertia that its point mass makes up; the rest is rotor."""
DUST = 1e-6
"""Mass and inertia of a part that must have some, kg and kg m^2."""


def model_of_arm(path: Path) -> Element:
    """Return the model of an arm, URDF or MJCF, as MuJoCo reads it; shapes are left out, since nothing is touched.

    Raises:
        ExportError: the file cannot be read.
        MujocoMissing: MuJoCo is not installed.
    """
    try:
        text = read_text(path, MAX_BYTES)
    except FileError as error:
        raise ExportError(f"{path}: cannot be read", value=error.reason, remedy="give --model") from error
    return model_of_text(text, str(path), path)


def model_of_text(text: str, label: str, path: Path | None = None) -> Element:
    """Return the model of a text as `model_of_arm` does of a file; `label` names it; raises ExportError too."""
    if "<mujoco" in text and "<robot" not in text:
        return whole(parse_xml(text, "mujoco"), path)
    root = parse_xml(text, "robot")
    for link in root.iter("link"):
        for shape in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(shape)
    try:
        spec = mujoco().MjSpec.from_string(tostring(root, encoding="unicode"))
        spec.compiler.boundmass = spec.compiler.boundinertia = DUST  # a link without either is refused
        return parse_xml(spec.to_xml(), "mujoco")
    except ValueError as error:
        raise ExportError(f"{label}: MuJoCo refuses it", value=str(error)[:200], remedy="give --model") from error


def model_of(parts: Sequence[AxisEvidence]) -> Element:
    """Return the nominal axes, each on a body of its own: mass, viscous friction, weight and a motor.

    Raises:
        ExportError: the mass of an axis is not known.
    """
    root = Element("mujoco", {"model": "axes"})
    SubElement(root, "compiler", {"angle": "radian"})
    SubElement(root, "option", {"timestep": "0.001", "gravity": f"0 0 -{GRAVITY:g}"})
    world, actuators = SubElement(root, "worldbody"), SubElement(root, "actuator")
    for part in parts:
        if is_law(part) or is_passive(part.axis):
            continue
        axis = part.axis
        if axis.servo or part.mass <= 0.0:
            remedy = "give a model with its mass and servo gains by --model FILE.mjcf"
            raise ExportError(
                f"{axis.name}: the description states no mass to simulate", value=part.mass, remedy=remedy
            )
        linear = axis.motion == "linear"
        body = SubElement(world, "body", {"name": f"{axis.name}_body"})
        joint = {"name": axis.name, "type": "slide" if linear else "hinge", "axis": "1 0 0" if linear else "0 1 0"}
        SubElement(body, "joint", {**joint, "damping": written(axis.viscous)}).set("limited", "false")
        _inertia(body, part, linear)
        SubElement(actuators, "motor", {"name": axis.name, "joint": axis.name, "ctrllimited": "false"})
        if axis.gravity.constant:
            law = {"gainprm": "0", "biastype": "affine", "biasprm": written(-axis.gravity.constant)}
            SubElement(actuators, "general", {"name": f"{axis.name}_weight", "joint": axis.name, **law})
    return root


def _inertia(body: Element, part: AxisEvidence, linear: bool) -> None:
    """A slide is a mass; a pendulum of inertia I and largest weight G is a point mass at G / (m g) and a rotor."""
    gravity, joint = part.axis.gravity, body[0]
    if linear or not gravity.arm:
        mass = part.mass if linear else DUST
        SubElement(body, "inertial", {"pos": "0 0 0", "mass": written(mass), "diaginertia": written(*[DUST] * 3)})
        if not linear:
            joint.set("armature", written(part.mass))
        return
    reach = SLENDER * part.mass * GRAVITY / abs(gravity.arm)
    mass = abs(gravity.arm) / (GRAVITY * reach)
    # weight torque against the drive is arm * sin(q - hanging); a turn about y moves the mass from -z towards -x
    hang = -gravity.hanging + (0.0 if gravity.arm > 0.0 else math.pi)
    place = (-reach * math.sin(hang), 0.0, -reach * math.cos(hang))
    SubElement(body, "inertial", {"pos": written(*place), "mass": written(mass), "diaginertia": written(*[DUST] * 3)})
    joint.set("armature", written((1.0 - SLENDER) * part.mass))
