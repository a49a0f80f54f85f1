"""Data files as named arrays: CSV (lists in cells too), MAT (to version 7), NPZ, JSON; a folder is many tables."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import scipy.io
from sher3_common import parse_json, read_json, read_text
from sher3_common.array_files import read_arrays
from sher3_diagnosis.channel import Array

from sher3_machines.errors import MachineError

Tables = dict[str, Array]
MAX_BYTES = 2_000_000_000
MAX_TEXT_BYTES = 500_000_000


def read_tables(path: Path) -> Tables:
    """Return the numeric arrays of a file, or of a folder's files as `stem/name`; the first index counts samples.

    Raises:
        MachineError: no such file, no known format, or a table that cannot be read.
    """
    if path.is_dir():
        files = [f for f in sorted(path.iterdir()) if f.suffix.lower() in READERS and f.suffix != ".txt"]
        if not files:
            raise MachineError(f"{path}: no data files", limit=", ".join(READERS), remedy="give a file or its folder")
        return {f"{f.stem}/{name}": x for f in files for name, x in _read(f).items()}
    if not path.is_file():
        raise MachineError(f"{path}: no such file", remedy="check the path")
    return _read(path)


def _read(path: Path) -> Tables:
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise MachineError(
            f"{path}: format is not read", value=path.suffix, limit=", ".join(READERS), remedy="convert it"
        )
    if path.stat().st_size > MAX_BYTES:
        raise MachineError(f"{path}: too large", value=path.stat().st_size, limit=MAX_BYTES, remedy="cut the record")
    try:
        return reader(path)
    except (OSError, ValueError, KeyError, IndexError, NotImplementedError, csv.Error) as error:
        raise MachineError(f"{path}: cannot be read", value=str(error)[:120], remedy="check the file") from error


def _csv(path: Path) -> Tables:
    """A header and rows, separated by commas, semicolons, tabs or blanks; without a header columns are c0, c1, ..."""
    text = read_text(path, MAX_TEXT_BYTES, "utf-8-sig")
    first = text.split("\n", 1)[0]
    mark = next((m for m in ",;\t" if m in first), None)
    lines = text.splitlines()
    rows = [r for r in (csv.reader(lines, delimiter=mark) if mark else (x.split() for x in lines)) if r]
    header, body = [h.strip().lstrip("# ") for h in rows[0]], rows[1:]
    if _numbers(rows[0]) is not None:
        header, body = [f"c{i}" for i in range(len(rows[0]))], rows
    out: Tables = {}
    for i, name in enumerate(header):
        values = _numbers([r[i] if i < len(r) else "" for r in body])
        if values is not None:
            out[name] = values
    return out


def _numbers(cells: list[str]) -> Array | None:
    """Cells as (n,) or, where they hold lists, (n, k); None for text."""
    try:
        if cells and cells[0].lstrip().startswith("["):
            return np.array([parse_json(c.replace("nan", "NaN")) for c in cells], dtype=float)
        return np.array([float(c) if c.strip() else np.nan for c in cells])
    except ValueError:
        return None


def _mat(path: Path) -> Tables:
    declared = sum(8 * math.prod(shape) for _, shape, _ in scipy.io.whosmat(path))
    if declared > MAX_BYTES:
        raise MachineError(f"{path}: unpacks to too much [bytes]", value=declared, limit=MAX_BYTES, remedy="cut it")
    return _numeric({k: v for k, v in scipy.io.loadmat(path).items() if not k.startswith("__")})


def _npz(path: Path) -> Tables:
    return _numeric(read_arrays(path, max_bytes=MAX_BYTES))


def _json(path: Path) -> Tables:
    """Named lists; a list of objects is a table, `name/key`."""
    data = read_json(path, MAX_TEXT_BYTES)
    if not isinstance(data, dict):
        raise ValueError("the top level is not an object of named arrays")
    found: dict[str, object] = {}
    for name, value in data.items():
        if isinstance(value, list) and value and isinstance(value[0], dict):
            keys = [k for k, x in value[0].items() if isinstance(x, int | float | list)]
            found |= {f"{name}/{k}": [row.get(k, np.nan) for row in value] for k in keys}
        elif isinstance(value, list) and value and not isinstance(value[0], str):
            found[name] = value
    return _numeric(found)


def _numeric(data: Mapping[str, object]) -> Tables:
    out: Tables = {}
    for name, value in data.items():
        x = np.asarray(value)
        if x.dtype.kind in "fiub" and x.ndim:
            x = np.asarray(x, dtype=float)
            out[name] = x.ravel() if x.ndim == 2 and 1 in x.shape else x
    return out


READERS: dict[str, Callable[[Path], Tables]] = {
    ".csv": _csv,
    ".tsv": _csv,
    ".txt": _csv,
    ".mat": _mat,
    ".npz": _npz,
    ".json": _json,
}
