"""ros2_control: the description of simulated hardware, with what a joint has beyond its model as parameters.

The schema of `<ros2_control>` gives a joint any parameters; hardware components read them from
`info_.joints[i].parameters`. `mock_components/GenericSystem` of Jazzy mirrors commands and ignores them: a component of
your own makes friction, dead time and lag of them. Effort limits are those of the command interface, which the joint
limiter of the controller manager enforces.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from sher3_export.changes import Change
from sher3_export.targets.links import INERTIAL
from sher3_export.targets.target import Target, each
from sher3_export.xml_file import write_xml, written

PARAMETERS = (
    *("coulomb", "static", "stribeck", "viscous", "load_loss", "offset", "drive", "inertia", "delay"),
    *("servo", "servo_position", "servo_velocity", "servo_delay", "lag", "zero"),
    *("cogging", "cogging_periods", "cogging_phase", "ratio", "backlash", "compliance", "spring", "rest"),
    *("noise_load", "resolution_load"),
)
"""Constants that become a parameter of the joint with their own name, SI units."""
READ = {
    name: name.split("_") for name in ("noise_position", "resolution_position", "noise_effort", "resolution_effort")
}
"""Constants of a reading -> name of a parameter of a state interface, and that interface."""
LINK = "it belongs to a link of the URDF, not to the hardware of a joint"


class Ros2Control(Target):
    """A `<ros2_control>` element to include in a URDF."""

    name, suffix = "ros2_control", "xml"
    fields: ClassVar[Mapping[str, str]] = {
        **{name: f'param "{name}"' for name in PARAMETERS},
        "limit": "min and max of the command interface `effort`",
        **{name: f'param "{kind}" of `{interface}`' for name, (kind, interface) in READ.items()},
    }
    refuses: ClassVar[Mapping[str, str]] = each(
        {
            " ".join(INERTIAL): LINK,
            "weight arm hanging link payload payload_x payload_y payload_z shift_x shift_y shift_z": LINK,
        }
    )

    def __init__(self) -> None:
        self.joints: dict[str, dict[str, float]] = {}

    def apply(self, change: Change) -> str:
        """Write a change into its joint; return why it cannot be written, or nothing."""
        if change.over_stiffness:
            return "given in units of the servo's stiffness, which is not known here"
        if change.constant not in self.fields:
            return self.refuses.get(change.constant, "hardware of a joint has no such parameter")
        joint = self.joints.setdefault(change.joint, {})
        for ending, value in (("", change.value), ("_low", change.low), ("_high", change.high)):
            name = f"{change.constant}{ending}"
            if value is not None:
                joint[name] = value + (0.0 if change.constant in ("limit", *READ) else joint.get(name, 0.0))
        return ""

    def text(self, remarks: Sequence[str]) -> str:
        """Return the element; every joint with the interfaces of an effort-controlled one."""
        root = Element("ros2_control", {"name": "simulated", "type": "system"})
        SubElement(SubElement(root, "hardware"), "plugin").text = "mock_components/GenericSystem"
        for name, constants in self.joints.items():
            joint = SubElement(root, "joint", {"name": name})
            command = SubElement(joint, "command_interface", {"name": "effort"})
            for constant, value in constants.items():
                if constant == "limit":
                    for end, sign in (("min", -1.0), ("max", 1.0)):
                        SubElement(command, "param", {"name": end}).text = written(sign * value)
                elif constant not in READ:
                    SubElement(joint, "param", {"name": constant}).text = written(value)
            for state in ("position", "velocity", "effort"):
                interface = SubElement(joint, "state_interface", {"name": state})
                for constant, (kind, read) in READ.items():
                    if read == state and constant in constants:
                        SubElement(interface, "param", {"name": kind}).text = written(constants[constant])
        ElementTree.indent(root)
        note = (
            "Parameters: SI units, beyond the nominal model; between _low and _high with 95 %, to draw from. "
            "noise: standard deviation of an interface. mock_components ignores them; your component reads them."
        )
        return write_xml(root, [*remarks, note])
