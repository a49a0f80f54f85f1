"""NPY, NPZ, JSON, JSON lines and Parquet."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from sher3_common import parse_json, read_json
from sher3_common.files.arrays import read_array, read_arrays
from sher3_diagnosis.channel import Array

from sher3_machines.errors import no_reader
from sher3_machines.intake.readers.cells import value_of
from sher3_machines.intake.readers.epics import is_archive, tables_of_archive
from sher3_machines.intake.readers.shapes import SAMPLES, plain
from sher3_machines.intake.readers.text import decoded

MAX_BYTES = 2_000_000_000
MAX_TEXT_BYTES = 500_000_000
SHOWN = 100
"""Cells of a column of text by which it is one of numbers."""


def read_npz(path: Path) -> dict[str, Array]:
    """Return the numeric arrays (n, ...) of a file by name; raises FileError as `read_arrays` does."""
    return numeric(read_arrays(path, max_bytes=MAX_BYTES))


def read_npy(path: Path) -> dict[str, Array]:
    """Return the fields (n, ...) of a record array, columns (n,) of a table as `c0`, `c1`..., more axes as `array`."""
    x = read_array(path, MAX_BYTES)
    if x.dtype.names:
        return numeric({name: x[name] for name in x.dtype.names})
    return numeric({f"c{i}": column for i, column in enumerate(x.T)} if x.ndim == 2 else {"array": x})


def read_lists(path: Path) -> dict[str, Array]:
    """Return named lists (n, ...) of a JSON file; objects nest as `name/key`, a list of objects is a table.

    A list of objects at the top is a table too, whose columns have the keys' names; one of whole records is a run for
    each, `run_1/key`. The answer of an EPICS archiver is a table for each of its channels. Raises ValueError where the
    top level is neither an object nor a list.
    """
    data = read_json(path, MAX_TEXT_BYTES)
    if is_archive(data):
        return tables_of_archive(data)
    found: dict[str, object] = {}
    _collect("", data, found)
    if not isinstance(data, dict | list):
        raise ValueError("the top level is neither an object nor a list")
    return numeric(found)


def _collect(name: str, value: object, found: dict[str, object]) -> None:
    below = f"{name}/" if name else ""
    if isinstance(value, dict):
        for key, part in value.items():
            _collect(f"{below}{key}", part, found)
    elif isinstance(value, list) and value and all(map(_is_record, value)):
        for i, part in enumerate(value, 1):
            _collect(f"{below}run_{i}", part, found)
    elif isinstance(value, list) and value and all(isinstance(row, dict) for row in value):
        for key in value[0]:
            _collect(f"{below}{key}", _as_rows([row.get(key) for row in value]), found)
    elif isinstance(value, list) and value:
        found[name] = value


def _is_record(value: object) -> bool:
    """Return whether an entry of a list is a record of its own: a list of objects, or lists of one length, of samples.

    A scan beside each sample is one list, and no record.
    """
    if isinstance(value, dict):
        lengths = [len(x) for x in value.values() if isinstance(x, list) and len(x) >= SAMPLES]
        return len(lengths) > len(set(lengths)) or any(map(_is_record, value.values()))
    return isinstance(value, list) and len(value) >= SAMPLES and all(isinstance(row, dict) for row in value)


def _as_rows(column: list[Any]) -> object:
    """Return one key of a list of objects as a list; objects in it as one object of lists, what is missing as nan."""
    there = [x for x in column if x is not None]
    if there and all(isinstance(x, dict) for x in there):
        keys = dict.fromkeys(key for x in there for key in x)
        return {key: _as_rows([x.get(key) if x is not None else None for x in column]) for key in keys}
    widths = {len(x) for x in there if isinstance(x, list)}
    nothing = [np.nan] * widths.pop() if len(widths) == 1 else np.nan
    return [nothing if x is None else x for x in column]


def read_lines(path: Path) -> dict[str, Array]:
    """Return the columns (lines, ...) of a file of one object a line; what one leaves out is nan. Raises ValueError."""
    rows = [parse_json(line) for line in decoded(path).splitlines() if line.strip()]
    if not rows or not all(isinstance(row, dict) for row in rows):
        raise ValueError("not every line is an object")
    keys = dict.fromkeys(key for row in rows for key in row)
    found: dict[str, object] = {}
    _collect("", [{key: row.get(key) for key in keys} for row in rows], found)
    return numeric(found)


def read_parquet(path: Path) -> dict[str, Array]:
    """Return the numeric columns of a Parquet file, lists as (n, k); raises MachineError where it has no reader."""
    try:
        parquet = import_module("pyarrow.parquet")
    except ImportError as error:
        raise no_reader(path, "Parquet", "pyarrow", "install sher3[lerobot], or convert to csv") from error
    table = parquet.read_table(path)
    return numeric({name: _plain(table[name]) for name in table.column_names})


def _plain(column: Any) -> object:
    """Return a column of Parquet as numbers, rows of lists as a matrix, and times as seconds since 1970."""
    x = column.to_numpy()
    if x.dtype.kind == "M":
        return x.astype("datetime64[ns]").astype(np.int64) * 1e-9
    if x.dtype == object and len(x) and all(isinstance(row, np.ndarray) for row in x):
        return np.stack([np.stack(row) if row.dtype == object else row for row in x])
    return x


def numeric(data: Mapping[str, object]) -> dict[str, Array]:
    """Return what of named values are arrays of numbers; (n, 1) and (1, n) become (n,)."""
    out: dict[str, Array] = {}
    for name, value in data.items():
        try:
            x = np.asarray(value)
        except ValueError:  # rows of different lengths are no signal
            continue
        x = _numbers(x) if x.dtype.kind in "OU" and x.ndim == 1 else x
        if x.dtype.kind in "fiub" and x.ndim:
            out[name] = plain(x)
    return out


def _numbers(x: Array) -> Array:
    """Return a column of text as numbers, nan for other words, where most of its first cells are numbers or nothing."""
    values = [value_of("" if cell is None else str(cell), False) for cell in x[:SHOWN]]
    if 2 * sum(isinstance(cell, float) for cell in values) <= len(values):
        return x
    values += [value_of("" if cell is None else str(cell), False) for cell in x[SHOWN:]]
    return np.array([cell if isinstance(cell, float) else np.nan for cell in values])
