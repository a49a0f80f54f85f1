"""Reading small text and YAML files: size-limited, safe loading only, no construction of objects."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from .errors import FileError

MAX_CONFIGURATION_BYTES = 1 << 20
"""A robot or configuration file is a few kilobytes; more than this [bytes] is a mistake."""

MAX_DEPTH = 32
"""Nesting of mappings and lists that any of our files stays far below."""


def read_text(path: Path | str, max_bytes: int = MAX_CONFIGURATION_BYTES) -> str:
    """Return the UTF-8 text of a regular file of at most `max_bytes`.

    Raises:
        FileError: missing, not a regular file, too large, unreadable or not UTF-8.
    """
    path = Path(path)
    if not path.is_file():
        what = "is not a regular file" if path.exists() else "no such file"
        raise FileError(what, path=path, remedy="give the path of an existing file")
    try:
        with path.open("rb") as stream:
            raw = stream.read(max_bytes + 1)
        if len(raw) > max_bytes:
            remedy = "give a file of the expected kind"
            raise FileError("too large [bytes]", path=path, value=path.stat().st_size, limit=max_bytes, remedy=remedy)
        return raw.decode("utf-8")
    except OSError as error:
        raise FileError(f"cannot be read: {error.strerror}", path=path, remedy="check its permissions") from error
    except UnicodeDecodeError as error:
        raise FileError("is not UTF-8 text", path=path, value=f"byte {error.start}", remedy="save as UTF-8") from error


def parse_yaml(text: str, source: Path | str = "<text>", max_bytes: int = MAX_CONFIGURATION_BYTES) -> dict[str, Any]:
    """Parse a YAML mapping of plain data.

    Aliases are refused as well: plain data needs none, and nested ones expand without bound.

    Raises:
        FileError: too long, not valid YAML, or not a mapping at the top.
    """
    if len(text) > max_bytes:
        raise FileError("too large [characters]", path=source, value=len(text), limit=max_bytes)
    try:
        _refuse_aliases_and_depth(text, source)
        data = yaml.load(text, Loader=_StrictLoader)
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        if isinstance(error, FileError):
            raise
        what = "is not valid YAML: " + " ".join(str(error).split())
        raise FileError(what, path=source, remedy="correct the file") from error
    if not isinstance(data, dict):
        raise FileError("holds no mapping", path=source, value=type(data).__name__, remedy="start with 'key: value'")
    return data


class _StrictLoader(yaml.SafeLoader):
    """Safe loading that refuses a key given twice, of which YAML would silently keep the last."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        keys = [key.value for key, _ in node.value]
        twice = next((key for key in keys if keys.count(key) > 1), None)
        if twice is not None:
            raise yaml.constructor.ConstructorError(None, None, f"key {twice!r} is given twice", node.start_mark)
        return super().construct_mapping(node, deep=deep)


def _refuse_aliases_and_depth(text: str, source: Path | str) -> None:
    depth = 0
    for event in yaml.parse(text, Loader=yaml.SafeLoader):
        place = f"line {event.start_mark.line + 1}" if event.start_mark else None
        depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
        if depth > MAX_DEPTH:
            raise FileError("is nested too deeply", path=source, value=place, limit=MAX_DEPTH, remedy="flatten it")
        if isinstance(event, yaml.AliasEvent):
            raise FileError("uses a YAML alias", path=source, value=place, remedy="write the value out")


def read_yaml(path: Path | str, max_bytes: int = MAX_CONFIGURATION_BYTES) -> dict[str, Any]:
    """Read and parse one YAML file; see `read_text` and `parse_yaml` for the errors raised."""
    return parse_yaml(read_text(path, max_bytes), source=path, max_bytes=max_bytes)
