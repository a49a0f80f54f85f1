"""Any message as CDR bytes, from plain data and the definition of its type."""

from __future__ import annotations

import re
import struct
from collections.abc import Mapping
from functools import cache
from typing import Any

from sher3_bags.messages import definition_of, field_lines

_FORMATS = {
    "bool": "?", "byte": "B", "char": "B", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i",
    "uint32": "I", "int64": "q", "uint64": "Q", "float32": "f", "float64": "d",
}  # fmt: skip
_KIND = re.compile(r"^([\w/]+)(?:\[(\d*)\])?$")
ENCAPSULATION = b"\x00\x01\x00\x00"


def packed(type_name: str, values: Mapping[str, Any]) -> bytes:
    """Return a message of a type such as `std_msgs/Header`; what `values` leaves out is zero or empty.

    Raises:
        TopicError: the type is unknown here. struct.error: a value does not fit its field.
    """
    out = bytearray()
    _message(out, type_name, values)
    return ENCAPSULATION + bytes(out)


def _message(out: bytearray, type_name: str, values: Mapping[str, Any]) -> None:
    for kind, count, name in _fields(type_name):
        value = values.get(name)
        if count is None:
            _one(out, kind, value)
            continue
        items = list(value or [])
        if count == 0:
            _number(out, "I", len(items))
        else:
            items += [None] * (count - len(items))
        for item in items:
            _one(out, kind, item)


@cache
def _fields(type_name: str) -> tuple[tuple[str, int | None, str], ...]:
    """Return kind, number of elements (0: any number, None: no array) and name of the fields of a type."""
    fields, package = [], type_name.split("/")[0]
    for line in field_lines(definition_of(type_name)):
        word, name = line.split()[:2]
        if "=" in name:
            continue  # a constant
        found = _KIND.match(word)
        assert found is not None, line
        kind, size = found.groups()
        if kind not in _FORMATS and kind != "string" and "/" not in kind:
            kind = f"{package}/{kind}"
        fields.append((kind, None if size is None else int(size or 0), name))
    return tuple(fields)


def _one(out: bytearray, kind: str, value: Any) -> None:
    if kind == "string":
        raw = str("" if value is None else value).encode() + b"\0"
        _number(out, "I", len(raw))
        out += raw
    elif kind in _FORMATS:
        _number(out, _FORMATS[kind], 0 if value is None else value)
    else:
        _message(out, kind, value or {})


def _number(out: bytearray, form: str, value: Any) -> None:
    size = struct.calcsize(form)
    out += bytes(-len(out) % size)
    out += struct.pack("<" + form, value)
