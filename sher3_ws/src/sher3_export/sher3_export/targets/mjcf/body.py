"""Parts of an MJCF model: what is fixed to a body, a body that moves, actuators that a control reaches."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from pathlib import PurePath
from xml.etree.ElementTree import Element

from sher3_export.changes import Change
from sher3_export.targets.links import Inertia
from sher3_export.xml_file import numbers, parents, written

BONES = ("compiler", "option", "size", "default", "asset", "worldbody")
"""Sections that say where bodies are and what they weigh."""
FRAME = "frame"


def skeleton(root: Element) -> Element:
    """Return the bodies of a model by themselves: no looks, and no mesh that no inertia is made of."""
    bare = deepcopy(root)
    for section in [x for x in bare if x.tag not in BONES]:
        bare.remove(section)
    for body in [x for x in bare.iter() if x.tag == "worldbody" or x.find("inertial") is not None]:
        _without_geoms(body)
    for element in bare.iter():
        element.attrib.pop("material", None)
    needed = {x.get("mesh") for x in bare.iter("geom")}
    for assets in bare.findall("asset"):
        for asset in [x for x in assets if x.tag != "mesh" or _called(x) not in needed]:
            assets.remove(asset)
    return bare


def _called(mesh: Element) -> str:
    """Return the name of a mesh, which is that of its file where it states none."""
    return mesh.get("name") or PurePath(mesh.get("file", "")).stem


def _without_geoms(part: Element) -> None:
    """Take the geoms out of a body, those in its frames too."""
    for child in list(part):
        if child.tag == "geom":
            part.remove(child)
        elif child.tag == FRAME:
            _without_geoms(child)


def inside(body: Element, tag: str) -> Iterator[Element]:
    """Yield the elements of a tag that a body holds itself or in its frames, which only place what they hold."""
    for child in body:
        if child.tag == tag:
            yield child
        elif child.tag == FRAME:
            yield from inside(child, tag)


def body_around(root: Element, element: Element) -> Element:
    """Return the body, or the world, that holds an element, itself or in a frame."""
    above = parents(root)
    found = above[element]
    while found.tag == FRAME:
        found = above[found]
    return found


def frames_around(above: Mapping[Element, Element], element: Element) -> list[Element]:
    """Return the frames that hold an element within its body, the innermost first; `above` are the parents of all."""
    found = []
    while (element := above[element]).tag == FRAME:
        found.append(element)
    return found


def in_frames(element: Element, frames: Sequence[Element]) -> Element:
    """Return an element within frames of their own that place it as those (the innermost first) do."""
    for frame in frames:
        around = Element(FRAME, {name: value for name, value in frame.attrib.items() if name != "name"})
        around.append(element)
        element = around
    return element


def class_value(root: Element, element: Element, attribute: str) -> str | None:
    """Return what the innermost class of <default> that states an attribute says, up to the model's top class."""
    above = parents(root)
    name, at = element.get("class"), element
    while name is None and at in above:
        at = above[at]
        name = at.get("childclass")
    top = root.find("default")
    if top is None:
        return None
    found = next((x for x in top.iter("default") if name is not None and x.get("class") == name), top)
    while found.tag == "default":
        stated = [x.get(attribute) for x in found.findall(element.tag) if attribute in x.attrib]
        if stated or found is top:
            return stated[-1] if stated else None
        found = above[found]
    return None


def together(body: Element) -> list[Element]:
    """Return a body and those below it that no joint parts from it."""
    below = [x for x in inside(body, "body") if not [*inside(x, "joint"), *inside(x, "freejoint")]]
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


def payloads_on(root: Element, link: str) -> list[Element]:
    """Return the payloads that exports have put on a link; each has a place of its own."""
    named = re.compile(rf"{re.escape(link)}_payload(_\d+)?")
    return [x for x in root.iter("body") if named.fullmatch(x.get("name", ""))]


def set_inertial(body: Element | None, inertia: Inertia) -> None:
    """Give a body mass, centre and inertia, in place of those that it states or that its geoms make."""
    if body is None:  # what a skeleton has, its model has
        return
    for standing in body.findall("inertial"):
        body.remove(standing)
    full = written(*(inertia.about[name] for name in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")))
    values = {"pos": written(*inertia.centre), "mass": written(inertia.mass), "fullinertia": full}
    body.insert(0, Element("inertial", values))
