"""Arrays from `.npy` and `.npz` files of bounded size, which is checked before any memory is allocated for it."""

from __future__ import annotations

import math
import os
import zipfile
import zlib
from collections.abc import Iterable
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib import format as npy

from sher3_common.errors import FileError
from sher3_common.files.text import read_bytes

MAX_ARRAY_BYTES = 256 << 20
"""Largest size of all arrays of one file together [bytes]; ten minutes of an excitation at 1 kHz take 48 MB."""

_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""How NumPy packs; readers of the others have errors of their own."""
_HEADERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}


def read_arrays(
    path: Path | str, names: Iterable[str] | None = None, max_bytes: int = MAX_ARRAY_BYTES
) -> dict[str, np.ndarray]:
    """Return arrays of an npz file by name. Objects are refused, so nothing is unpickled.

    Args:
        path: of the file.
        names: the arrays to read, by default all of them.
        max_bytes: largest file, and largest size of the unpacked arrays together.

    Raises:
        FileError: the file is not regular, no npz file or too large; an array is missing, damaged or holds objects.
    """
    raw = read_bytes(path, max_bytes)
    try:
        with zipfile.ZipFile(BytesIO(raw)) as archive:
            members = {os.path.splitext(member.filename)[0]: member for member in archive.infolist()}
            wanted = list(members if names is None else names)
            missing = [name for name in wanted if name not in members]
            if missing:
                raise FileError("lacks an array", path=path, value=missing[0], limit=", ".join(members))
            _check_total([members[name] for name in wanted], path, max_bytes)
            return {name: _read(archive, members[name], path) for name in wanted}
    except (zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError, EOFError, OSError, ValueError) as error:
        if isinstance(error, FileError):
            raise
        raise FileError(f"is no whole npz file: {error}", path=path, remedy="write it again") from error


def read_array(path: Path | str, max_bytes: int = MAX_ARRAY_BYTES) -> np.ndarray:
    """Return the array of an npy file. Objects are refused, so nothing is unpickled.

    Raises:
        FileError: the file is not regular, no npy file or too large; it is damaged or holds objects.
    """
    raw = read_bytes(path, max_bytes)
    try:
        return _array(BytesIO(raw), len(raw), Path(path).name, path)
    except ValueError as error:
        if isinstance(error, FileError):
            raise
        raise FileError(f"is no whole npy file: {error}", path=path, remedy="write it again") from error


def _check_total(members: list[zipfile.ZipInfo], path: Path | str, max_bytes: int) -> None:
    """Raise FileError when the members declare more than `max_bytes` in all."""
    total = sum(member.file_size for member in members)
    if total > max_bytes:
        remedy = "give a file of the expected kind"
        raise FileError("unpacks to too much [bytes]", path=path, value=total, limit=max_bytes, remedy=remedy)


def _read(archive: zipfile.ZipFile, member: zipfile.ZipInfo, path: Path | str) -> np.ndarray:
    """Return one array; raises FileError when its header declares more than the member holds."""
    if member.compress_type not in _METHODS:
        raise ValueError(f"{member.filename}: packed by method {member.compress_type}")
    with archive.open(member) as stream:
        found = _array(stream, member.file_size, member.filename, path)
        stream.read(1)  # the end of the member, where its checksum is compared
    return found


def _array(stream: Any, held: int, name: str, path: Path | str) -> np.ndarray:
    """Return the array that begins at a stream of `held` bytes."""
    shape, fortran, dtype = _header(stream, name)
    size = math.prod(shape) * dtype.itemsize
    if dtype.hasobject or min(shape, default=0) < 0 or size > held:
        value = f"{name}: {shape} of {dtype}"
        remedy = "write plain numbers with numpy.save or numpy.savez"
        raise FileError("declares what it does not hold", path=path, value=value, remedy=remedy)
    content = bytearray(stream.read(size))
    flat: Any = np.frombuffer(content, dtype=dtype) if size else np.empty(0, dtype)
    return flat.reshape(shape, order="F" if fortran else "C")


def _header(stream: Any, name: str) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    """Return shape, order and type of the array that begins at a stream; ValueError where no header says them."""
    version = npy.read_magic(stream)
    if version not in _HEADERS:
        raise ValueError(f"{name}: version {version}")
    try:
        found: tuple[tuple[int, ...], bool, np.dtype[Any]] = _HEADERS[version](stream)
    except Exception as error:  # it is read as Python: SyntaxError, TokenError, MemoryError of the parser, and more
        raise ValueError(f"{name}: its header cannot be read ({type(error).__name__})") from error
    return found
