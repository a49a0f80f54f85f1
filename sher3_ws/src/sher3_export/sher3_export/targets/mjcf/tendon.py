"""Motors that move several joints, in MuJoCo: a fixed tendon whose length is the motor's travel."""

from __future__ import annotations

from collections.abc import Mapping
from xml.etree.ElementTree import Element, SubElement

from sher3_export.changes import Change
from sher3_export.targets.target import XmlTarget
from sher3_export.xml_file import number, written

FIELDS: Mapping[str, str] = {"coulomb": "frictionloss", "viscous": "damping", "inertia": "armature"}
"""Constant -> attribute of a tendon that acts on its length."""


def at_motor(target: XmlTarget, change: Change, travel: Mapping[str, float]) -> str:
    """Write a constant of a motor at a fixed tendon; return why it cannot be written, or nothing.

    Args:
        target: the model.
        change: of the motor, by its own travel.
        travel: joint -> travel of the motor per travel of the joint.
    """
    if missing := sorted(travel.keys() - target.joints.keys()):
        return f"the model has no joint {missing[0]} (joints: {', '.join(list(target.joints)[:12])}); see --motor"
    if change.constant not in FIELDS:
        return f"of a motor that moves several joints a tendon has {', '.join(FIELDS.values())} alone"
    tendon, attribute = _tendon(target.root, f"{change.joint}_motor", travel), FIELDS[change.constant]
    total = number(tendon.get(attribute)) + change.value
    tendon.set(attribute, written(max(total, 0.0)))
    return "" if total >= 0.0 else f"{attribute} would be {total:.4g}; set to zero, the rest is not expressed"


def _tendon(root: Element, name: str, travel: Mapping[str, float]) -> Element:
    """Return the tendon of a motor, made where there is none."""
    section = root.find("tendon")
    section = SubElement(root, "tendon") if section is None else section
    standing = next((x for x in section if x.get("name") == name), None)
    if standing is not None:
        return standing
    added = SubElement(section, "fixed", {"name": name})
    for joint, share in travel.items():
        SubElement(added, "joint", {"joint": joint, "coef": written(share)})
    return added
