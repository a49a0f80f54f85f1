"""SDF: dynamics and effort limit of a joint's axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar
from xml.etree.ElementTree import Element

from sher3_effects.page import NOISE

from sher3_export.changes import Change
from sher3_export.targets.links import INERTIAL
from sher3_export.targets.target import NOT_GIVEN, Row, XmlTarget, each
from sher3_export.targets.urdf import PAYLOAD, child
from sher3_export.xml_file import number, written


class Sdf(XmlTarget):
    """A model or world of the Simulation Description Format."""

    name, root_tag = "sdf", "sdf"
    suffix = "sdf"
    refuses: ClassVar[Mapping[str, str]] = {
        **NOT_GIVEN,
        **each(
            {
                "static": "SDF friction is the same at rest and in motion; only the sliding level was written",
                "stribeck": "SDF friction does not depend on speed",
                "offset": "an SDF joint has no constant force",
                "weight": "a share of the weight without its inertia is no mass of a link",
                "inertia": "an SDF joint has no rotor inertia",
                "drive delay lag servo servo_position servo_velocity servo_delay": "an SDF joint has no drive; gain, "
                "delay and lag belong to the controller plugin",
                "cogging cogging_periods cogging_phase": "an SDF joint has no force over its angle",
                "zero": "an SDF joint has no offset of its zero; turn the pose of its child by hand",
                "backlash": "an SDF joint has no play; add a joint by hand or export to mjcf",
                "compliance": "the spring of an SDF joint acts between its links, not between motor and load",
                "link": "the inertial element of a link is no part of a joint; scale its mass and inertia by hand",
                " ".join(INERTIAL): "the inertial element is no part of a joint; export a URDF and convert it",
                "payload payload_x payload_y payload_z": PAYLOAD,
                " ".join(NOISE): "SDF has noise for sensors of a link, and no sensor that reads a joint",
                "shift_x shift_y shift_z": "the pose of the child link belongs to the model's tree; shift it by hand",
            }
        ),
    }

    def all_joints(self) -> Sequence[Element]:
        """Return the joints that move."""
        return [x for x in self.root.iter("joint") if x.get("type") != "fixed" and x.find("axis") is not None]

    def nominal(self) -> dict[str, dict[str, float]]:
        """Return friction and damping of joints; an SDF knows no rotor."""
        return {
            name: {c: number(joint.findtext(f"axis/dynamics/{self.fields[c]}")) for c in ("coulomb", "viscous")}
            for name, joint in self.joints.items()
        }

    def _add(self, joint: Element, group: str, name: str, change: float) -> str:
        """Add to a number that stands as an element's text."""
        value = child(child(child(joint, "axis"), group), name)
        value.text = written(max(number(value.text) + change, 0.0))
        return ""

    def _rest(self, change: Change, joint: Element) -> str:
        child(child(child(joint, "axis"), "dynamics"), "spring_reference").text = written(change.value)
        return ""

    def _limit(self, change: Change, joint: Element) -> str:
        child(child(child(joint, "axis"), "limit"), "effort").text = written(change.value)
        return ""

    rows: ClassVar[Mapping[str, Row]] = {
        "coulomb": Row("friction", lambda to, change, joint: to._add(joint, "dynamics", "friction", change.value)),
        "viscous": Row("damping", lambda to, change, joint: to._add(joint, "dynamics", "damping", change.value)),
        "limit": Row("effort", _limit),
        "spring": Row(
            "spring_stiffness", lambda to, change, joint: to._add(joint, "dynamics", "spring_stiffness", change.value)
        ),
        "rest": Row("spring_reference", _rest),
    }
