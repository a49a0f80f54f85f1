"""An MJCF model in one piece: files it includes, sections in several parts, and what MuJoCo makes of its macros."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, tostring

from sher3_export.errors import ExportError
from sher3_export.targets.mjcf.body import class_value
from sher3_export.xml_file import numbers, parse_xml, read_xml, written

MACROS = ("replicate", "attach", "composite", "flexcomp")
"""Elements that stand for others, which MuJoCo writes out."""
DEEPEST = 20
"""Files that include each other, one in the other, at most."""
SERVO = ("gaintype", "gainprm", "biastype", "biasprm", "input")
"""Attributes of an actuator by which MuJoCo writes out a <position>."""
DYNAMICS = ("dyn", "act")
"""How attributes begin that only a <general> has."""


def read_mjcf(path: Path) -> Element:
    """Return the root of a model's file in one piece; raises ExportError as `read_xml` does."""
    return whole(read_xml(path, "mujoco"), path)


def whole(root: Element, path: Path | None = None) -> Element:
    """Return a model in one piece.

    Args:
        root: of the model, changed in place.
        path: of its file, beside which the files lie that it includes; None: these lie where the program runs.

    Raises:
        ExportError: a file cannot be read, or MuJoCo is needed and missing or refuses the model.
    """
    _include(root, Path() if path is None else path.parent, DEEPEST)
    if any(next(root.iter(macro), None) is not None for macro in MACROS):
        root = _written_out(root, path)
    return _servos(_merged(root))


def _include(parent: Element, folder: Path, deep: int) -> None:
    """Put what included files hold in the place of each <include>."""
    for child in list(parent):
        if child.tag != "include":
            _include(child, folder, deep)
            continue
        if not deep:
            remedy = "take one <include> of the circle out"
            raise ExportError("files include each other", value=child.get("file"), limit=DEEPEST, remedy=remedy)
        held = read_xml(folder / child.get("file", ""), "mujocoinclude", "mujoco")
        _include(held, folder, deep - 1)
        at = list(parent).index(child)
        parent[at : at + 1] = list(held)


def _merged(root: Element) -> Element:
    """Put sections of the same name together, as MuJoCo does; what is stated last holds."""
    first: dict[str, Element] = {}
    for section in [x for x in root if isinstance(x.tag, str)]:
        own = first.setdefault(section.tag, section)
        if own is not section:
            own.attrib.update(section.attrib)
            own.extend(section)
            root.remove(section)
    return root


def _written_out(root: Element, path: Path | None) -> Element:
    """Return a model as MuJoCo writes it, without macros."""
    try:
        spec: Any = import_module("mujoco").MjSpec
        found = spec.from_string(tostring(root, encoding="unicode")) if path is None else spec.from_file(str(path))
        found.compile()
        return parse_xml(found.to_xml(), "mujoco")
    except ImportError as error:
        remedy = "install the extra `mujoco` of this project"
        raise ExportError("a model with macros needs MuJoCo", value=", ".join(MACROS), remedy=remedy) from error
    except ValueError as error:
        remedy = "correct it until MuJoCo loads it"
        raise ExportError("MuJoCo refuses the model", value=str(error)[:120], remedy=remedy) from error


def _servos(root: Element) -> Element:
    """Write each <general> with the law k (control - q) - d v as the <position> it is: its gains are then kp and kv."""
    stated = sorted({name for x in root.iter("general") for name in x.attrib} - {"class"})
    for actuator in [x for block in root.findall("actuator") for x in block if x.tag == "general"]:
        held = {name: class_value(root, actuator, name) for name in stated}
        own = {name: x for name, x in {**held, **actuator.attrib}.items() if x is not None and name != "class"}
        gain, bias = numbers(own.get("gainprm"), "1")[0], [*numbers(own.get("biasprm"), "0"), 0.0, 0.0]
        affine = own.get("biastype") == "affine" and bias[:2] == [0.0, -gain] and own.get("input", "pos") == "pos"
        kept = {name: x for name, x in own.items() if name not in SERVO}
        if affine and not any(name.startswith(DYNAMICS) for name in kept):
            actuator.attrib.clear()
            actuator.tag = "position"
            actuator.attrib.update({**kept, "kp": written(gain), "kv": written(-bias[2])})
    return root
