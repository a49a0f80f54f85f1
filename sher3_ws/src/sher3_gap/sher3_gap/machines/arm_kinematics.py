"""Forward kinematics of a serial arm from a DH table or a URDF."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from scipy.spatial.transform import Rotation
from sher3_description import FileError, read_text

from sher3_gap.channels import Array
from sher3_gap.machines.description import ArmMachine
from sher3_gap.machines.errors import MachineError

MAX_URDF_BYTES = 4_000_000


@dataclass(frozen=True)
class Arm:
    """Joint i turns by q about `axes[i]` after the fixed transform `fixed[i]`; then `tip`.

    Attributes:
        names: (k); fixed: (k, 4, 4); axes: (k, 3) unit vectors; tip: (4, 4).
    """

    names: tuple[str, ...]
    fixed: Array
    axes: Array
    tip: Array


@dataclass(frozen=True)
class Postures:
    """Along n postures, in the base frame.

    Attributes:
        tip: (n, 4, 4); frames: (n, k, 4, 4) joint frames before their turn; axes: (n, k, 3).
    """

    tip: Array
    frames: Array
    axes: Array


def arm_of(machine: ArmMachine) -> Arm:
    """Build the arm of a description. Raises `MachineError` for a URDF that has no such chain."""
    if machine.urdf is not None:
        return _from_urdf(machine.urdf, machine.base_link, machine.tip_link)
    fixed = []
    for j in machine.joints:
        about = transform(rotation=Rotation.from_rotvec([j.alpha, 0.0, 0.0]).as_matrix())
        turned = transform([0.0, 0.0, j.d], Rotation.from_rotvec([0.0, 0.0, j.offset]).as_matrix())
        fixed.append(about @ transform([j.a, 0.0, 0.0]) @ turned)
    axes = np.tile([0.0, 0.0, 1.0], (len(fixed), 1))
    return Arm(tuple(j.name for j in machine.joints), np.array(fixed), axes, transform([0.0, 0.0, machine.tip]))


def transform(position: Array | list[float] | None = None, rotation: Array | None = None) -> Array:
    """A homogeneous transform (4, 4)."""
    out = np.eye(4)
    if rotation is not None:
        out[:3, :3] = rotation
    if position is not None:
        out[:3, 3] = position
    return out


def postures(arm: Arm, q: Array) -> Postures:
    """Forward kinematics of joint positions (n, k)."""
    n, k = q.shape
    frames, axes = np.empty((n, k, 4, 4)), np.empty((n, k, 3))
    pose = np.tile(np.eye(4), (n, 1, 1))
    for i in range(k):
        pose = pose @ arm.fixed[i]
        frames[:, i], axes[:, i] = pose, pose[:, :3, :3] @ arm.axes[i]
        turn = np.tile(np.eye(4), (n, 1, 1))
        turn[:, :3, :3] = Rotation.from_rotvec(q[:, [i]] * arm.axes[i]).as_matrix()
        pose = pose @ turn
    return Postures(pose @ arm.tip, frames, axes)


def _from_urdf(path: Path, base: str, tip: str) -> Arm:
    try:
        text = read_text(path, MAX_URDF_BYTES)
        if "<!DOCTYPE" in text:  # what declares entities can expand without bound or name other files
            raise MachineError(f"{path}: has a document type", value="<!DOCTYPE", remedy="give a plain URDF file")
        root = ElementTree.fromstring(text)
    except (FileError, ElementTree.ParseError) as error:
        raise MachineError(f"{path}: cannot be read", value=str(error), remedy="give a URDF file") from error
    above = {j.find("child").attrib["link"]: j for j in root.iter("joint") if j.find("child") is not None}  # type: ignore[union-attr]
    chain, link = [], tip
    while link != base:
        if link not in above:
            links = ", ".join(x.attrib["name"] for x in root.iter("link"))
            raise MachineError(
                f"{path}: no chain from {base!r} to {tip!r}", value=link, limit=links, remedy="name its links"
            )
        chain.append(above[link])
        link = above[link].find("parent").attrib["link"]  # type: ignore[union-attr]
    names, fixed, axes, pending = [], [], [], np.eye(4)
    for joint in reversed(chain):
        pending = pending @ _origin(joint)
        kind = joint.attrib["type"]
        if kind in ("revolute", "continuous"):
            names.append(joint.attrib["name"])
            fixed.append(pending)
            axis = joint.find("axis")
            u = np.array([1.0, 0.0, 0.0] if axis is None else [float(x) for x in axis.attrib["xyz"].split()])
            axes.append(u / np.linalg.norm(u))
            pending = np.eye(4)
        elif kind != "fixed":
            raise MachineError(
                f"{path}: joint {joint.attrib['name']} is not revolute", value=kind, remedy="use a DH table"
            )
    return Arm(tuple(names), np.array(fixed), np.array(axes), pending)


def _origin(joint: ElementTree.Element) -> Array:
    origin = joint.find("origin")
    if origin is None:
        return np.eye(4)
    xyz, rpy = ([float(x) for x in origin.attrib.get(k, "0 0 0").split()] for k in ("xyz", "rpy"))
    return transform(xyz, Rotation.from_euler("xyz", rpy).as_matrix())
