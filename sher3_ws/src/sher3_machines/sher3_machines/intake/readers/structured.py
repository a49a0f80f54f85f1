"""NPZ, JSON and Parquet."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path

import numpy as np
from sher3_common import read_json
from sher3_common.array_files import read_arrays
from sher3_diagnosis.channel import Array

from sher3_machines.errors import MachineError

MAX_BYTES = 2_000_000_000
MAX_TEXT_BYTES = 500_000_000


def read_npz(path: Path) -> dict[str, Array]:
    """Return the numeric arrays of a file."""
    return numeric(read_arrays(path, max_bytes=MAX_BYTES))


def read_lists(path: Path) -> dict[str, Array]:
    """Return named lists of a JSON file; objects nest as `name/key`, a list of objects is a table.

    A list of objects at the top is a table too, whose columns have the keys' names.
    """
    data = read_json(path, MAX_TEXT_BYTES)
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
    elif isinstance(value, list) and value and all(isinstance(row, dict) for row in value):
        for key in value[0]:
            _collect(f"{below}{key}", _as_rows([row.get(key) for row in value]), found)
    elif isinstance(value, list) and value:
        found[name] = value


def _as_rows(column: list[object]) -> object:
    """Return one key of a list of objects as a list; objects in it as one object of lists, missing numbers as nan."""
    if all(isinstance(x, dict) for x in column):
        first = column[0]
        assert isinstance(first, dict)
        return {key: _as_rows([x.get(key) for x in column if isinstance(x, dict)]) for key in first}
    return [np.nan if x is None else x for x in column]


def read_parquet(path: Path) -> dict[str, Array]:
    """Return the numeric columns of a Parquet file; raises MachineError where no reader is installed."""
    try:
        table = import_module("pyarrow.parquet").read_table(path)
    except ImportError as error:
        raise MachineError(
            f"{path}: no reader for Parquet",
            value="pyarrow is not installed",
            remedy="install pyarrow, or convert to csv",
        ) from error
    return numeric({name: table[name].to_numpy() for name in table.column_names})


def numeric(data: Mapping[str, object]) -> dict[str, Array]:
    """Return what of named values are arrays of numbers; (n, 1) and (1, n) become (n,)."""
    out: dict[str, Array] = {}
    for name, value in data.items():
        try:
            x = np.asarray(value)
        except ValueError:  # rows of different lengths are no signal
            continue
        if x.dtype.kind in "fiub" and x.ndim:
            x = np.asarray(x, dtype=float)
            out[name] = x.ravel() if x.ndim == 2 and 1 in x.shape else x
    return out
