"""Parts of an MJCF model: what is fixed to a body, a body that moves, actuators that a control reaches."""

from __future__ import annotations

from xml.etree.ElementTree import Element

from sher3_export.changes import Change
from sher3_export.xml_file import numbers, written


def together(body: Element) -> list[Element]:
    """Return a body and those below it that no joint parts from it."""
    below = [x for x in body.findall("body") if x.find("joint") is None and x.find("freejoint") is None]
    return [body, *(part for x in below for part in together(x))]


def controlled(actuator: Element) -> bool:
    """Return whether a control reaches an actuator: it has an input, and a gain."""
    return actuator.get("gainprm") != "0" and actuator.get("input") != "none"


def moved(body: Element, change: Change) -> str:
    """Move a body along the axis that the constant of a change ends with; return nothing: it could be written."""
    place = numbers(body.get("pos"), "0 0 0")
    place["xyz".index(change.constant[-1])] += change.value
    body.set("pos", written(*place))
    return ""
