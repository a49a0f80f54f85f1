"""MATLAB files: to version 7 by SciPy, from version 7.3 on they are HDF5."""

from __future__ import annotations

import math
import struct
import zlib
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_machines.intake.readers.hdf5 import MAGIC, NO_NUMBERS, read_raw
from sher3_machines.intake.readers.native import read_in_child, whole
from sher3_machines.intake.readers.shapes import plain, stacked

ORDERS = {b"IM": "<", b"MI": ">"}
"""Order of the bytes in files of versions 5 to 7, by the mark in their header."""
HEADER, COMPRESSED = 128, 15
"""Length of that header, bytes, and the type of an element that is packed (MAT-File Format, The MathWorks)."""
STEP = 1 << 20
"""Bytes that are unpacked at a time while they are counted."""
MAX_DEPTH = 8
"""Structs within structs that are opened."""
MOST_CELLS = 200
"""Cells that are opened: runs, or joints; those of a table of text are more."""
CLASS = "_Class"
"""Field of what the reader makes of a class object."""
NAMES, NUMBERS = ("name", "label"), ("data", "values")
"""Fields of a struct that holds a signal under its name: captures of dSPACE, structures with time of Simulink."""
SIGNALS = "signals"
WITH_TIME = {"time", SIGNALS}
"""Fields of a structure with time of Simulink: its signals go beside their stamps."""
HDF5 = b"MATLAB 7.3"
"""How files of version 7.3 begin."""


def read_mat(path: Path) -> dict[str, Array]:
    """Return the numeric arrays of a file; fields of structs are `struct/field`, struct arrays are stacked (rows, ...).

    Raises:
        MachineError: the file is of version 7.3, and no reader of these is installed.
        ValueError: its reader ended without an answer.
    """
    raw = whole(path)
    return read_raw(path, raw) if raw.startswith((HDF5, MAGIC)) else read_in_child("mat", raw)


def arrays(raw: bytes, limit: int) -> dict[str, Array]:
    """Return the arrays (n, ...) of a file to version 7; raises ValueError without any, or over `limit` unpacked.

    Args:
        raw: the file.
        limit: bytes that its arrays may take, unpacked.
    """
    import scipy.io

    declared = _declared(BytesIO(raw))
    for size in (declared, unpacked_size(raw, limit)):
        if size > limit:
            raise ValueError(f"unpacks to too much: {size} bytes, limit {limit}")
    found: dict[str, Array] = {}
    for name, value in scipy.io.loadmat(BytesIO(raw), verify_compressed_data_integrity=True).items():
        if not name.startswith("__"):
            found |= flatten(name, value)
    if not any(x.size for x in found.values()):
        raise ValueError(NO_NUMBERS)
    return found


def flatten(name: str, value: Any, depth: int = 0) -> dict[str, Array]:
    """Return numeric arrays (n, ...) of a value of `scipy.io.loadmat`, by path: (0,) of a class object, no text."""
    x = np.asarray(value)
    if depth > MAX_DEPTH:
        return {}
    if CLASS in (x.dtype.names or ()):
        return {name: np.zeros(0)}
    if x.dtype.names:
        if titled := _titled(x):
            return {f"{name}/{title}" if name else title: array for title, array in titled.items()}
        beside = {SIGNALS: ""} if set(x.dtype.names) >= WITH_TIME else {}
        parts = [{n: flatten(beside.get(n, n), row[n], depth + 1) for n in x.dtype.names} for row in x.ravel()]
        merged: dict[str, list[Array]] = {}
        for part in parts:
            for found in part.values():
                for key, array in found.items():
                    merged.setdefault(f"{name}/{key}" if name else key, []).append(array)
        return {key: stacked(arrays) for key, arrays in merged.items() if len(arrays) == len(parts)}
    if x.dtype == object:
        return _cells(name, x, depth)
    if x.dtype.kind in "fiub" and x.ndim and x.size:
        return {name: plain(x)}
    return {}


def _cells(name: str, x: Any, depth: int) -> dict[str, Array]:
    """Return the arrays in a cell array: of one cell under its own name, of several numbered from one; `name/2`."""
    if x.size > MOST_CELLS:
        return {}
    titles = [name] if x.size == 1 else [f"{name}/{i + 1}" for i in range(x.size)]
    parts = (flatten(title, cell, depth + 1) for title, cell in zip(titles, x.ravel(), strict=True))
    return {key: array for part in parts for key, array in part.items()}


def _titled(x: Any) -> dict[str, Array]:
    """Return the signals of an array of structs by the names that stand in them, or by their number; empty without."""
    fields = {n.lower(): n for n in x.dtype.names}
    title, numbers = (next((fields[n] for n in known if n in fields), None) for known in (NAMES, NUMBERS))
    if title is None or numbers is None:
        return {}
    said = ["".join(map(str, np.ravel(row[title]))).replace('"', "").strip("/ ") for row in x.ravel()]
    arrays = [np.asarray(row[numbers]) for row in x.ravel()]
    said = [name or str(i + 1) for i, name in enumerate(said)] if any(said) else said
    if not all(said) or len(set(said)) < len(said) or any(a.dtype.kind not in "fiub" or not a.size for a in arrays):
        return {}
    return {title: plain(array) for title, array in zip(said, arrays, strict=True)}


def unpacked_size(raw: bytes, limit: int) -> int:
    """Return what the packed elements of a file unpack to, bytes, cells and structs within them too.

    Nothing is kept, and counting ends a step beyond `limit`.

    Args:
        raw: the file.
        limit: of interest, bytes.
    """
    order, at, total = ORDERS.get(raw[HEADER - 2 : HEADER]), HEADER, 0
    while order is not None and at + 8 <= len(raw) and total <= limit:
        kind, size = struct.unpack_from(f"{order}2I", raw, at)
        at += 8
        if kind == COMPRESSED:
            inflate = zlib.decompressobj()
            rest = raw[at : at + size]
            while rest and total <= limit:
                total += len(inflate.decompress(rest, STEP))
                rest = inflate.unconsumed_tail
        else:
            size += -size % 8
        at += size
    return total


def _declared(raw: BytesIO) -> int:
    """Return the bytes that the arrays of a file take; 0 where it holds a class object, whose size is not told."""
    import scipy.io

    try:
        return sum(8 * math.prod(shape) for _, shape, _ in scipy.io.whosmat(raw))
    except TypeError:
        return 0
