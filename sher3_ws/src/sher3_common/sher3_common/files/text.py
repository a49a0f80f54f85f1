"""The doors of files: regular files of bounded size read as bytes, text, YAML or JSON; folders made for new ones.

What is read is plain data: no objects are constructed, aliases are refused, and the nesting is bounded. Arrays have a
door of their own, `files.arrays`.
"""

from __future__ import annotations

import json
import os
import re
import stat
from collections import Counter
from pathlib import Path
from typing import Any

import yaml

from sher3_common.errors import FileError

MAX_CONFIGURATION_BYTES = 1 << 20
"""A robot or configuration file has a few kilobytes; one with more than this [bytes] is a mistake."""

MAX_DEPTH = 32
"""Deepest nesting of mappings and lists; every file of the project stays far below it."""

_SafeLoader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_SafeDumper: Any = getattr(yaml, "CSafeDumper", yaml.SafeDumper)


def read_bytes(path: Path | str, max_bytes: int = MAX_CONFIGURATION_BYTES) -> bytes:
    """Return the content of a regular file of at most `max_bytes`; what is appended while it is read is left out.

    Raises:
        FileError: the file is missing, unreadable or too large, or it is a folder, pipe, device or socket.
    """
    path = Path(path)
    try:
        _require_regular(os.stat(path), path)
        # Between the two looks the file may have become a pipe. Opened so, it never makes this wait.
        with os.fdopen(os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC), "rb") as stream:
            status = os.fstat(stream.fileno())
            _require_regular(status, path)
            if status.st_size > max_bytes:
                remedy = "give a file of the expected kind"
                raise FileError("too large [bytes]", path=path, value=status.st_size, limit=max_bytes, remedy=remedy)
            return stream.read(status.st_size)
    except FileNotFoundError as error:
        raise FileError("no such file", path=path, remedy="give the path of an existing file") from error
    except OSError as error:
        raise FileError(f"cannot be read: {error.strerror}", path=path, remedy="check path and permissions") from error


def make_folder(path: Path | str) -> Path:
    """Make a folder and those above it; one that exists is left as it is.

    Raises:
        FileError: it cannot be made: a file is in the way, the place is read-only or full.
    """
    path = Path(path)
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        remedy = "choose a place where you may write"
        raise FileError(f"folder cannot be made: {error.strerror}", path=path, remedy=remedy) from error
    return path


def _require_regular(status: os.stat_result, path: Path) -> None:
    if not stat.S_ISREG(status.st_mode):
        kind = {stat.S_IFDIR: "folder", stat.S_IFIFO: "pipe", stat.S_IFSOCK: "socket"}
        value = kind.get(stat.S_IFMT(status.st_mode), "device")
        raise FileError("is not a regular file", path=path, value=value, remedy="give the path of an existing file")


def read_text(path: Path | str, max_bytes: int = MAX_CONFIGURATION_BYTES, encoding: str = "utf-8") -> str:
    """Return the UTF-8 text of a regular file of at most `max_bytes`; `utf-8-sig` drops a byte-order mark.

    Raises:
        FileError: as in `read_bytes`, or the file is not UTF-8.
    """
    try:
        return read_bytes(path, max_bytes).decode(encoding)
    except UnicodeDecodeError as error:
        raise FileError("is not UTF-8 text", path=path, value=f"byte {error.start}", remedy="save as UTF-8") from error


def parse_yaml(text: str, source: Path | str = "<text>", max_bytes: int = MAX_CONFIGURATION_BYTES) -> dict[str, Any]:
    """Return the mapping of plain data that a YAML text holds.

    Aliases are refused: plain data needs none, and nested aliases expand without bound. So are tags, which say what a
    value is instead of the program that reads it, and numbers that YAML 1.1 reads to another base than people do: 1:30
    is 90 to it, and 010 is 8.

    Args:
        text: the YAML text.
        source: where it comes from, for errors.
        max_bytes: longest text, in characters.

    Raises:
        FileError: the text is too long, no valid YAML, nested too deeply, or no mapping; it uses an alias
            or a tag, gives a key twice, or a number to another base than ten.
    """
    if len(text) > max_bytes:
        remedy = "give a file of the expected kind"
        raise FileError("too large [characters]", path=source, value=len(text), limit=max_bytes, remedy=remedy)
    try:
        _refuse_what_is_not_plain(text, source)
        data = yaml.load(text, Loader=_StrictLoader)
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        if isinstance(error, FileError):
            raise
        what = "is not valid YAML: " + " ".join(str(error).split())
        raise FileError(what, path=source, remedy="correct the file") from error
    if not isinstance(data, dict):
        raise FileError("holds no mapping", path=source, value=type(data).__name__, remedy="start with 'key: value'")
    return data


_OTHER_BASE = re.compile(r"[-+]?(\d[\d_]*(:[0-5]?\d)+(\.[\d_]*)?|0[0-7_]+|0[bx][\da-fA-F_]+)")
"""Plain scalars that YAML 1.1 takes for numbers to base 60, 8, 2 or 16."""


class _StrictLoader(_SafeLoader):
    """Safe loading that refuses a key given twice; YAML itself would silently keep the last value."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        keys = Counter(key.value for key, _ in node.value if isinstance(key, yaml.ScalarNode))
        twice = next((key for key, count in keys.items() if count > 1), None)
        if twice is not None:
            raise yaml.constructor.ConstructorError(None, None, f"key {twice!r} is given twice", node.start_mark)
        return super().construct_mapping(node, deep=deep)


def _refuse_what_is_not_plain(text: str, source: Path | str) -> None:
    depth = 0
    for event in yaml.parse(text, Loader=_SafeLoader):
        place = f"line {event.start_mark.line + 1}" if event.start_mark else None
        depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
        if depth > MAX_DEPTH:
            raise FileError("is nested too deeply", path=source, value=place, limit=MAX_DEPTH, remedy="flatten it")
        if isinstance(event, yaml.AliasEvent):
            raise FileError("uses a YAML alias", path=source, value=place, remedy="write the value out")
        tag = getattr(event, "tag", None)
        if tag is not None:
            remedy = "write plain values; what they are follows from their place"
            raise FileError("uses a YAML tag", path=source, value=f"{tag} in {place}", remedy=remedy)
        if isinstance(event, yaml.ScalarEvent) and event.implicit[0] and _OTHER_BASE.fullmatch(event.value):
            remedy = "write a decimal number, or quote a text"
            raise FileError("holds a number of YAML 1.1", path=source, value=f"{event.value} in {place}", remedy=remedy)


def read_yaml(path: Path | str, max_bytes: int = MAX_CONFIGURATION_BYTES) -> dict[str, Any]:
    """Return the mapping in a YAML file; raises the errors of `read_text` and `parse_yaml`."""
    return parse_yaml(read_text(path, max_bytes), source=path, max_bytes=max_bytes)


class _PlainDumper(_SafeDumper):
    """Writes a value that occurs twice out in full both times, because `parse_yaml` takes no aliases."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def dump_yaml(data: Any) -> str:
    """Return plain data as YAML that `parse_yaml` reads back."""
    return str(yaml.dump(data, Dumper=_PlainDumper, sort_keys=False))


def parse_json(text: str | bytes, source: Path | str = "<text>") -> Any:
    """Return the value of a JSON text; `source` names it in errors.

    Raises:
        FileError: the text is no valid JSON, or nested too deeply.
    """
    try:
        return json.loads(text)
    except RecursionError as error:
        raise FileError("is nested too deeply", path=source, remedy="flatten it") from error
    except ValueError as error:
        raise FileError(f"is not valid JSON: {error}", path=source, remedy="correct the file") from error


def read_json(path: Path | str, max_bytes: int = MAX_CONFIGURATION_BYTES) -> Any:
    """Return the value in a JSON file; raises the errors of `read_text` and `parse_json`."""
    return parse_json(read_text(path, max_bytes), source=path)
