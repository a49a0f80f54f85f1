"""Ranges and noise in an MJCF file: `<custom><numeric name="elbow/coulomb" data="1.1 1.3"/>`, to draw from.

MuJoCo loads them as `model.numeric("elbow/coulomb").data`. They are what a constant may be beyond the nominal model, SI
units, with 95 %; the model holds the value between them. Of the noise of readings the one number is the value itself.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from xml.etree.ElementTree import Element, SubElement

from sher3_export.changes import Change
from sher3_export.xml_file import numbers, written

SENSORS: Mapping[str, tuple[str, str]] = {
    "noise_position": ("jointpos", "actuatorpos"),
    "noise_effort": ("jointactuatorfrc", "actuatorfrc"),
}
"""Noise of a reading -> sensors of it, at the joint and at its actuator."""


def write_range(root: Element, change: Change) -> None:
    """Write the interval of a constant, where it has one, added to what an export before has written there."""
    if change.low is None or change.high is None or change.over_stiffness:
        return
    standing = _numeric(root, change)
    low, high = numbers(standing.get("data"), "0 0")
    standing.set("data", written(low + change.low, high + change.high))


def write_noise(root: Element, change: Change, actuators: Collection[str | None]) -> str:
    """Write noise or step of a joint's readings, and the noise of the sensors that it has; return nothing.

    MuJoCo 3.1.4 and later add no noise: `noise` of a sensor is where a program that draws it looks it up.
    """
    _numeric(root, change).set("data", written(change.value))
    at_joint, at_actuator = SENSORS.get(change.constant, ("", ""))
    for sensor in (x for block in root.findall("sensor") for x in block):
        if (sensor.tag == at_joint and sensor.get("joint") == change.joint) or (
            sensor.tag == at_actuator and sensor.get("actuator") in actuators
        ):
            sensor.set("noise", written(change.value))
    return ""


def _numeric(root: Element, change: Change) -> Element:
    """Return the element that holds the numbers of a constant, made where there is none."""
    name = f"{change.joint}/{change.constant}"
    standing = next((x for x in root.iter("numeric") if x.get("name") == name), None)
    if standing is None:
        custom = root.find("custom")
        custom = SubElement(root, "custom") if custom is None else custom
        standing = SubElement(custom, "numeric", {"name": name})
    return standing
