"""MATLAB files to version 7, read in a child process: the reader is native code that a bad file can crash."""

from __future__ import annotations

import math
import os
import struct
import subprocess
import sys
import tempfile
import zlib
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from sher3_common import read_bytes
from sher3_common.array_files import read_arrays
from sher3_diagnosis.channel import Array

from sher3_machines.intake.readers.hdf5 import MAGIC, refused

MAX_MEMORY = 4_000_000_000
"""Address space of the child, bytes: twice the largest file that is read."""
MAX_SECONDS = 120.0
"""Time the child may take; 2 GB from a slow disk take a minute."""
MAX_BYTES = 2_000_000_000
"""Largest arrays of a file together, and all that its compressed parts unpack to, bytes."""
ORDERS = {b"IM": "<", b"MI": ">"}
"""Order of the bytes in files of versions 5 to 7, by the mark in their header."""
HEADER, COMPRESSED = 128, 15
"""Length of that header, bytes, and the type of an element that is packed (MAT-File Format, The MathWorks)."""
STEP = 1 << 20
"""Bytes that are unpacked at a time while they are counted."""
MAX_DEPTH = 8
"""Structs within structs that are opened."""
CLASS = "_Class"
"""Field of what the reader makes of a class object."""
HDF5 = b"MATLAB 7.3"
"""How files of version 7.3 begin."""


def read_mat(path: Path) -> dict[str, Array]:
    """Return the numeric arrays of a file; fields of structs are `struct/field`, rows of struct arrays stacked.

    Raises:
        MachineError: the file is of version 7.3.
        ValueError: its reader ended without an answer.
    """
    raw = read_bytes(path, MAX_BYTES)
    if raw.startswith((HDF5, MAGIC)):
        raise refused(path, "MATLAB's version 7.3, which is HDF5,", "save it in MATLAB with the option -v7, or ")
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "arrays.npz"
        command = [sys.executable, "-m", __name__, str(MAX_BYTES), str(out)]
        limits = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
        try:
            done = subprocess.run(
                command, input=raw, env={**os.environ, **limits}, capture_output=True, timeout=MAX_SECONDS, check=False
            )
        except subprocess.TimeoutExpired as error:
            raise ValueError(f"its reader took more than {MAX_SECONDS:g} s") from error
        if done.returncode != 0 or not out.is_file():
            said = done.stderr.decode(errors="replace").strip().splitlines()
            raise ValueError(said[-1] if done.returncode == 1 and said else f"its reader crashed ({done.returncode})")
        return {name.replace("\\", "/"): x for name, x in read_arrays(out, max_bytes=MAX_BYTES).items()}


def flatten(name: str, value: Any, depth: int = 0) -> dict[str, Array]:
    """Return the numeric arrays in a value of `scipy.io.loadmat`, by path; class objects and text are left out."""
    x = np.asarray(value)
    if depth > MAX_DEPTH or CLASS in (x.dtype.names or ()):
        return {}
    if x.dtype.names:
        parts = [{n: flatten(n, row[n], depth + 1) for n in x.dtype.names} for row in x.ravel()]
        merged: dict[str, list[Array]] = {}
        for part in parts:
            for found in part.values():
                for key, array in found.items():
                    merged.setdefault(f"{name}\\{key}" if name else key, []).append(array)
        return {key: stacked(arrays) for key, arrays in merged.items() if len(arrays) == len(parts)}
    if x.dtype == object and x.size == 1:
        return flatten(name, x.ravel()[0], depth + 1)
    if x.dtype.kind in "fiub" and x.ndim and x.size:
        x = np.asarray(x, dtype=float)
        return {name: x.ravel() if x.ndim == 2 and 1 in x.shape else x}
    return {}


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


def stacked(arrays: list[Array]) -> Array:
    """Return the one array of a struct, or those of a struct array one after the other."""
    if len(arrays) == 1:
        return arrays[0]
    if len({x.shape for x in arrays}) == 1:
        return np.stack([x[0] if x.shape == (1,) else x for x in arrays])
    return np.concatenate([x.ravel() for x in arrays])


def _declared(raw: BytesIO) -> int:
    """Return the bytes that the arrays of a file take; 0 where it holds a class object, whose size is not told."""
    import scipy.io

    try:
        return sum(8 * math.prod(shape) for _, shape, _ in scipy.io.whosmat(raw))
    except TypeError:
        return 0


def main(limit: int, target: str) -> int:
    """Read a file from standard input in this process, with limits, and write its arrays; return the exit code.

    Args:
        limit: largest arrays together, bytes.
        target: path of the npz file to write.
    """
    import resource

    import scipy.io

    resource.setrlimit(resource.RLIMIT_AS, (MAX_MEMORY, MAX_MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (MAX_MEMORY, MAX_MEMORY))
    raw = sys.stdin.buffer.read()
    try:
        declared = _declared(BytesIO(raw))
        for size in (declared, unpacked_size(raw, limit)):
            if size > limit:
                raise ValueError(f"unpacks to too much: {size} bytes, limit {limit}")
        found: dict[str, Array] = {}
        for name, value in scipy.io.loadmat(BytesIO(raw), verify_compressed_data_integrity=True).items():
            if not name.startswith("__"):
                found |= flatten(name, value)
    except Exception as error:  # whatever the reader makes of a bad file: the parent turns it into a typed error
        print(f"{type(error).__name__}: {error}".replace("\n", " ")[:200], file=sys.stderr)
        return 1
    np.savez(target, **found)  # type: ignore[arg-type]
    return 0


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]), sys.argv[2]))
