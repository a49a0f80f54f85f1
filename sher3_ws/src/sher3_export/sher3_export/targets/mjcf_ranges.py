"""Ranges in an MJCF file: `<custom><numeric name="elbow/coulomb" data="1.1 1.3"/>`, to draw from in randomisation.

MuJoCo loads them as `model.numeric("elbow/coulomb").data`. They are what a constant may be beyond the nominal model, SI
units, with 95 %; the model holds the value between them.
"""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

from sher3_export.changes import Change
from sher3_export.xml_file import numbers, written


def write_range(root: Element, change: Change) -> None:
    """Write the interval of a constant, where it has one, added to what an export before has written there."""
    if change.low is None or change.high is None or change.over_stiffness:
        return
    name = f"{change.joint}/{change.constant}"
    standing = next((x for x in root.iter("numeric") if x.get("name") == name), None)
    if standing is None:
        custom = root.find("custom")
        custom = SubElement(root, "custom") if custom is None else custom
        standing = SubElement(custom, "numeric", {"name": name})
    low, high = numbers(standing.get("data"), "0 0")
    standing.set("data", written(low + change.low, high + change.high))
