"""The arms: a small one of our own, and those whose URDF files the wheel `example-robot-data` ships."""

from __future__ import annotations

import sysconfig
from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree

from sher3_common import read_text

from sher3_arms.errors import ArmsError

MAX_BYTES = 5_000_000
"""Largest URDF that is read."""
OWN = "own"
"""The arm of our own: three joints, so that the whole path runs where the wheel is missing."""
FILES: Mapping[str, str] = {
    "panda": "panda_description/urdf/panda.urdf",
    "ur5": "ur_description/urdf/ur5_robot.urdf",
    "ur10": "ur_description/urdf/ur10_robot.urdf",
    "kinova": "kinova_description/robots/kinova.urdf",
    "xarm7": "xarm_description/urdf/xarm7.urdf",
    "z1": "z1_description/urdf/z1.urdf",
    "so101": "so_arm_description/urdf/so101.urdf",
}
"""Name of an arm -> its URDF below the wheel's folder of robots."""
MOVING = ("revolute", "continuous")
"""Joints that are moved; grippers slide, or are named so, and stay where they are."""
OWN_URDF = """<robot name="own">
  <link name="base"/>
  <link name="trunk"><inertial><origin xyz="0 0 0.1"/><mass value="4"/>
    <inertia ixx="0.03" iyy="0.03" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="upper"><inertial><origin xyz="0.18 0.01 0"/><mass value="3"/>
    <inertia ixx="0.01" iyy="0.04" izz="0.04" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="lower"><inertial><origin xyz="0.15 0 0.02"/><mass value="1.6"/>
    <inertia ixx="0.004" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="trunk"/><axis xyz="0 0 1"/>
    <limit lower="-2.6" upper="2.6" effort="90" velocity="3"/></joint>
  <joint name="lift" type="revolute"><parent link="trunk"/><child link="upper"/><origin xyz="0 0 0.25"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="90" velocity="3"/></joint>
  <joint name="bend" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0.35 0 0"/>
    <axis xyz="0 1 0"/><limit lower="-2.4" upper="2.4" effort="50" velocity="4"/></joint>
</robot>"""


def urdf_of(name: str) -> str:
    """Return the URDF of an arm, without shapes, and with every joint but the turning ones fixed.

    Raises:
        ArmsError: no such arm, or the wheel is not installed.
    """
    if name == OWN:
        return OWN_URDF
    if name not in FILES:
        raise ArmsError("no such arm", value=name, limit=", ".join((OWN, *FILES)), remedy="choose one of them")
    path = _robots() / FILES[name]
    if not path.is_file():
        remedy = "install the extra `arms` of this project, or use `own`"
        raise ArmsError("the wheel example-robot-data is not installed", value=str(path), remedy=remedy)
    root = ElementTree.fromstring(read_text(path, MAX_BYTES))
    for link in root.iter("link"):
        for shape in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(shape)
    for extra in [x for x in root if x.tag not in ("link", "joint")]:
        root.remove(extra)
    for joint in root.findall("joint"):
        grips = any(word in joint.attrib["name"].lower() for word in ("finger", "gripper"))
        if joint.get("type") not in (*MOVING, "fixed") or grips:
            joint.set("type", "fixed")
        for part in ("dynamics", "mimic", "safety_controller", "calibration"):
            for found in joint.findall(part):
                joint.remove(found)
    return ElementTree.tostring(root, encoding="unicode")


def _robots() -> Path:
    """Return the folder of robots of the wheel."""
    return Path(sysconfig.get_paths()["purelib"]) / "cmeel.prefix/share/example-robot-data/robots"
