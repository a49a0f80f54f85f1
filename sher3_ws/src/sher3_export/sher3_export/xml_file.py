"""Models in XML: read with their comments, one attribute changed at a time, written with a comment on top."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from sher3_common import FileError, read_text

from sher3_export.errors import ExportError

MAX_BYTES = 20_000_000
"""Largest model that is read: arms and humanoids with every mesh named are below 1 MB."""


def read_xml(path: Path, *roots: str) -> Element:
    """Return the root of an XML file, which is one of `roots`, comments kept.

    Raises:
        ExportError: the file cannot be read, declares entities, or has another root element.
    """
    try:
        return parse_xml(read_text(path, MAX_BYTES), *roots)
    except FileError as error:
        raise ExportError(f"{path}: cannot be read", value=error.reason, remedy="check the path") from error
    except ExportError as error:
        raise ExportError(f"{path}: {error.what}", value=error.value, limit=error.limit, remedy=error.remedy) from error


def parse_xml(text: str, *roots: str) -> Element:
    """Return the root of an XML text, comments kept; raises ExportError as `read_xml` does."""
    if "<!DOCTYPE" in text:  # what declares entities can expand without bound or name other files
        raise ExportError("has a document type", value="<!DOCTYPE", remedy="give a plain XML file")
    parser = ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True))
    try:
        found = ElementTree.fromstring(text, parser)
    except (ElementTree.ParseError, ValueError) as error:
        raise ExportError("is not XML", value=str(error), remedy="check the file") from error
    if found.tag not in roots:
        raise ExportError(
            "is another kind of model", value=f"<{found.tag}>", limit=f"<{roots[0]}>", remedy="check --to"
        )
    return found


def write_xml(root: Element, remarks: Sequence[str]) -> str:
    """Return the model as text, with the remarks as the first thing inside its root."""
    safe = "\n".join(f"  {line}" for line in remarks).replace("--", "- -")
    root.insert(0, ElementTree.Comment(f"\n{safe}\n"))
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode") + "\n"
    root.remove(root[0])
    return text


def elements(root: Element, tag: str) -> Iterator[Element]:
    """Yield all elements of a tag at any depth."""
    yield from root.iter(tag)


def parents(root: Element) -> dict[Element, Element]:
    """Return child -> parent of a whole tree."""
    return {child: parent for parent in root.iter() for child in parent}


def number(text: str | None, default: float = 0.0) -> float:
    """Return the first number of an attribute; `default` where there is none.

    Raises:
        ExportError: it is no number.
    """
    if text is None or not text.split():
        return default
    try:
        return float(text.split()[0])
    except ValueError as error:
        raise ExportError("a number of the model cannot be read", value=text, remedy="correct the model") from error


def numbers(text: str | None, default: str) -> list[float]:
    """Return all numbers of an attribute; raises ExportError where one is none."""
    return [number(part) for part in (text or default).split()]


def written(*values: float) -> str:
    """Return numbers as an attribute, with all digits that matter."""
    return " ".join(f"{value:.10g}" for value in values)


def add(element: Element, attribute: str, change: float, least: float | None = 0.0) -> None:
    """Add to the first number of an attribute, and keep it at `least` or above."""
    value = number(element.get(attribute)) + change
    rest = (element.get(attribute) or "").split()[1:]
    element.set(attribute, " ".join([written(value if least is None else max(value, least)), *rest]))
