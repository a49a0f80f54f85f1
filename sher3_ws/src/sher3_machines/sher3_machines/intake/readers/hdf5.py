"""HDF5 files, where `h5py` is installed: those of MATLAB's version 7.3, of simulators, loggers and learned policies."""

from __future__ import annotations

import math
from importlib import import_module
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_machines.errors import no_reader
from sher3_machines.intake.readers.native import read_in_child, whole
from sher3_machines.intake.readers.shapes import plain, stacked

NO_NUMBERS = (
    "no array of numbers; a table or another object of MATLAB is opened there alone: writetable, or save arrays"
)
"""What is said of a file without one."""
MAGIC = b"\x89HDF\r\n\x1a\n"
"""How HDF5 files begin; behind 512 bytes of a header those of MATLAB."""
ENDINGS = (".h5", ".hdf5", ".hdf", ".he5", ".h5df")
CLASS = "MATLAB_class"
"""Attribute by which MATLAB says what a dataset is; such arrays lie by columns, so their axes come in reverse."""
INTEGERS = tuple(f"{sign}int{bits}".encode() for sign in ("", "u") for bits in (8, 16, 32, 64))
NUMBERS = (b"double", b"single", b"logical", *INTEGERS)
"""Classes of MATLAB that are numbers; text, tables and class objects are left out."""
KINDS = "fiub"
"""Kinds of NumPy's types that are numbers."""
PICTURE = 3
"""Axes from which on bytes are pictures and no samples."""


def read_hdf5(path: Path) -> dict[str, Array]:
    """Return the numeric datasets (n, ...) of a file by their path, fields of compound ones as `dataset/field`.

    Pictures, text, links and what lies in another file are left out. Structs of MATLAB are `struct/field`.

    Raises:
        MachineError: no reader is installed.
        ValueError: its reader ended without an answer.
    """
    return read_raw(path, whole(path))


def read_raw(path: Path, raw: bytes) -> dict[str, Array]:
    """Return the arrays (n, ...) as `read_hdf5` does, of a file that is in memory; raises the same errors."""
    if find_spec("h5py") is None:
        remedy = "install sher3[hdf5], or save it as npz or csv, in MATLAB with the option -v7"
        raise no_reader(path, "HDF5", "h5py", remedy)
    return read_in_child("hdf5", raw)


def arrays(raw: bytes, limit: int) -> dict[str, Array]:
    """Return the arrays (n, ...) of a file; raises ValueError where they exceed `limit`, bytes, or none is there."""
    with import_module("h5py").File(BytesIO(raw), "r") as file:
        wanted: dict[str, Any] = {}
        file.visititems(lambda name, x: wanted.update({name: x} if _may_be_samples(name, x) else {}))  # follows no link
        size = sum(8 * math.prod(x.shape) * max(len(x.dtype.names or ()), 1) for x in wanted.values())
        if size > limit:
            raise ValueError(f"unpacks to too much: {size} bytes, limit {limit}")
        columns = [_columns(file, name, dataset) for name, dataset in wanted.items()]
    found = {name: x for part in columns for name, x in part.items() if x.size}
    if not found:
        raise ValueError(NO_NUMBERS)
    return found


def _may_be_samples(name: str, x: Any) -> bool:
    """Whether a name is that of a dataset with entries of its own, here and not in another file, and no picture."""
    if name.startswith("#") or not hasattr(x, "dtype") or not x.shape or x.external or x.is_virtual:
        return False
    return not (x.dtype == np.uint8 and x.ndim >= PICTURE) and "MATLAB_empty" not in x.attrs


def _columns(file: Any, name: str, dataset: Any) -> dict[str, Array]:
    """Return the arrays of a dataset by name."""
    of_matlab = dataset.attrs.get(CLASS)
    if dataset.dtype.names:
        fields = [n for n in dataset.dtype.names if dataset.dtype[n].kind in KINDS]
        return {f"{name}/{field}": plain(dataset[field]) for field in fields}
    if "ref" in (dataset.dtype.metadata or {}):  # a cell, or a field of a struct array
        parts = [file[reference] for reference in dataset[()].T.ravel() if reference]
        numbers = parts and all(x.attrs.get(CLASS) in NUMBERS for x in parts)
        return {name: stacked([plain(x[()].T) for x in parts])} if numbers else {}
    if dataset.dtype.kind not in KINDS or of_matlab not in (None, *NUMBERS):
        return {}
    return {name: plain(dataset[()] if of_matlab is None else dataset[()].T)}
